//! What the panels ask of the window.

use std::path::PathBuf;

use glam::Vec3;
use sculptd_clay::face_sets::{FaceSetPart, Partition};
use sculptd_clay::measured_mask::MaskMeasure;
use sculptd_daemon::decimate_job::DecimateWanted;
use sculptd_daemon::quad_job::QuadsWanted;
use sculptd_daemon::remesh_job::Wanted;
use sculptd_daemon::repair_jobs::RepairRequest;
use sculptd_daemon::symmetrise_job::SymmetriseWanted;
use sculptd_daemon::trim::Part;
use sculptd_daemon::window_link::NextSculpture;
use sculptd_devices::pad_actions::{Binding, Control};
use sculptd_engine::camera::Camera;
use sculptd_engine::command::Command;
use sculptd_engine::hand::MenuItem;
use sculptd_engine::local_remesh::LocalRemesh;
use sculptd_engine::scene::{ObjectId, Primitive};

use super::action::Action;
use super::outliner::Pairing;
use super::views::ViewKind;

/// Request of a panel.
#[derive(Debug, Clone)]
#[allow(clippy::large_enum_variant)] // A few a frame, on the stack.
pub enum UiRequest {
    World(Command),
    /// To a place of the session's history.
    Jump(u64),
    Camera(Camera),
    /// One view is shown, this one.
    ShowView(ViewKind),
    /// The camera comes to look at this place.
    FlyTo(Vec3),
    /// The running check ends without a result.
    CancelCheck,
    /// The objects are checked, whatever was found before.
    CheckAgain,
    OpenMesh(PathBuf),
    /// The file chooser shows this folder.
    ListFolder(PathBuf),
    /// The mesh is written, over a file of that name too.
    Export(PathBuf),
    /// The window goes on with another sculpture; this one is closed as by closing the window.
    OpenNext(NextSculpture),
    /// The held object is joined with the object.
    Join(MenuItem),
    /// An object of a primitive is added.
    AddPrimitive(Primitive),
    /// Adds the held object to the scene.
    AddHeld,
    /// Changes the numbers of a primitive.
    Reshape(ObjectId, Primitive),
    /// A Boolean of the active object and another; the result replaces both, or follows them.
    BooleanWith(Pairing),
    /// A mirrored twin of an object, in a plane through the origin: 0 of x, 1 of y, 2 of z.
    Mirror(ObjectId, usize),
    /// Cuts off this part of the view.
    Trim(Part),
    /// The object one level finer, or coarser.
    Level(bool),
    /// The object gets one surface of even triangles.
    Remesh(Wanted),
    /// The active object gets face sets by its shape.
    MakeSets(Partition),
    /// Triangles of a part of the active object get one size.
    RemeshLocal(LocalRemesh),
    /// Masks the measured vertices of the active object.
    MaskMeasured(MaskMeasure),
    /// A part of the active object becomes a new one of this thickness, in the unit of the scene.
    Extract(FaceSetPart, f64),
    /// The object gets quads that follow its shape.
    Quads(QuadsWanted),
    /// The object gets fewer triangles.
    Decimate(DecimateWanted),
    /// The object is repaired for printing or moulding.
    Repair(RepairRequest),
    /// One side of the active object from the other.
    Symmetrise(SymmetriseWanted),
    /// Distances are those to the object as it is now.
    Reference,
    /// The shadow's outline is written.
    Outline(PathBuf),
    /// The loop waits for a control of a tablet, which then does nothing, or no longer does.
    TabletListen(bool),
    /// Binds a control of a tablet; `None`: its default.
    TabletBinding(Control, Option<Binding>),
    /// Picks the colour of the clay at this place of the window, in points, for the active brush.
    SampleColour(egui::Pos2),
    /// The brush in hand becomes one of the person's own.
    SaveBrush {
        name: String,
        replace: bool,
    },
    /// For the window: dialogs and pictures.
    Do(Action),
}
