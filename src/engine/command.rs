//! Every way to change the world that is not a [`sculptd_devices::Sample`]: a panel's click, a
//! control-socket call, a finished Boolean, an undo.
//!
//! A command is plain data and serialises whole: no lock, channel or thread handle is part of one.
//! Data that takes long to build (built clay, pages of the session file) is named by a
//! [`PayloadId`] and kept in a store beside the world, see [`crate::payload`].
//! [`crate::world::World::answers`] reports the results. Only [`crate::world::World::step`] reads
//! commands.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use crate::camera::Camera;
use crate::desktop_layout::DesktopLayout;
use crate::hand::{ReachBox, Similarity};
use crate::mask_region::MaskRegion;
use crate::payload::PayloadId;
use crate::scene::{ObjectId, ObjectSettings, SceneCommand};
use crate::stroke::CurveAction;
use sculptd_clay::brush::{BrushSettings, MaskAction, Picture};
use sculptd_clay::{Cut, Levels, ObjectState, VertexState};
use sculptd_geometry::TriMesh;

/// Something that was asked of the world.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub enum Command {
    /// The brush and its settings; values out of range are clamped.
    Brush(BrushSettings),
    /// The view that pens draw in. A camera with values that are not finite is ignored.
    Camera(Camera),
    /// Ends every open stroke as a lifted pen does, then undoes the last step.
    Undo,
    /// Redoes the step that was undone last.
    Redo,
    /// Ends every open stroke as a lifted pen does; of several people, those of whoever asks, where
    /// the others' can be told apart from them.
    LiftAll,
    /// Changes the mask of the whole object: one step of undo.
    Mask(MaskAction),
    /// The picture of heights that brushes with the alpha `picture` press.
    Picture(Arc<Picture>),
    /// Another object takes the place of this one: a file was loaded, a Boolean finished.
    Replace(NewClay),
    /// The hands take up an object: a primitive or a loaded mesh, to carry it to its place.
    TakeUp(Arc<TriMesh>),
    /// The hands hold nothing any more: their object was put away, or joined with the clay.
    PutDown,
    /// The next five seconds of hands say what the person can reach.
    CalibrateReach,
    /// This part of the tracked space is mapped to the space around the object.
    Reach(ReachBox),
    /// Starts a new person with a new world; nothing of the previous one remains.
    Begin(Box<Beginning>),
    /// The object in the hands is placed here.
    Place(Similarity),
    /// A Boolean with a small tool: made where the clay around it is as it was when the cut was
    /// computed, else not at all.
    Cut(Carving),
    /// The object becomes what it was at another node of its history, as the session file keeps it.
    Jump(Box<Jump>),
    /// The session was reopened: steps to undo or redo exist only in the file.
    Reopened,
    /// As [`Command::Replace`], with a mask for each vertex, so that what was protected stays so.
    ReplaceMasked(NewClay, Arc<Vec<f32>>),
    /// To the curve that a pen has laid with the method `curve`: drawn, put away, a handle less.
    CurveStroke(CurveAction),
    /// Position of the tablets' pens in the view, as a window has learned it, and the areas that
    /// cover the view. A layout with values that are not finite is ignored.
    DesktopLayout(DesktopLayout),
    /// Objects are added, removed, moved, made active.
    Scene(SceneCommand),
    /// Another command, carried out only where the clay that it was computed for is the active one.
    OfClay(Box<OfClay>),
    /// The whole scene becomes what it was at another node of its history.
    JumpScene(Box<SceneJump>),
    /// Sets the mask of what is seen in a region of the view: one step of undo.
    MaskRegion(MaskRegion),
    /// Another command, of one of several people at one world: the view and the brush that it sets
    /// or needs are that person's.
    OfPerson(Box<OfPerson>),
    /// A sculpture that several people had shared goes on with one: the view and the brush are
    /// those of the first of them, and every device is that person's.
    OnePerson,
    /// Another command that puts new objects or new clay in place, and their vertices that differ
    /// from the triangles there: strokes that were made while these were computed.
    Rebased(Box<Rebased>),
}

/// A command that puts new clay in place, and what of the vertices differs from its triangles.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Rebased {
    /// Wrapped command: a [`Command::OfClay`] or a [`Command::Scene`].
    pub command: Command,
    /// For each new clay, in the order of the command.
    pub vertices: Arc<Vec<Vec<VertexState>>>,
}

/// A command, and whose it is.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct OfPerson {
    /// The person's number; 0 is the one whom every world has.
    pub person: u8,
    /// Wrapped command; never a [`Command::OfPerson`].
    pub command: Command,
}

/// A command that was computed for a clay, and that clay.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct OfClay {
    /// The number of the clay, [`sculptd_clay::Clay::object_id`].
    pub clay: u32,
    /// The revision that it must still have; `None`: whatever it has.
    pub revision: Option<u64>,
    /// Wrapped command; never a [`Command::OfClay`] or a [`Command::Rebased`].
    pub command: Command,
}

/// To another node of the history, where the scene was another. As [`Jump`], whoever sends or
/// replays it fetches the clays, as the payload [`SceneJump::payload_id`].
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct SceneJump {
    /// The node's number.
    pub node: u64,
    /// The active clay and the revision that it was made for: the world ignores it when the clay
    /// has changed since.
    pub from: (u32, u64),
    /// All objects, in order.
    pub objects: Vec<JumpObject>,
    /// The place of the active one.
    pub active: u32,
}

/// An object as a [`SceneJump`] puts it in place.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct JumpObject {
    /// Its id.
    pub id: ObjectId,
    /// Everything but its clay.
    pub settings: ObjectSettings,
    /// Every page of its clay, and its revision.
    pub pages: Vec<(u32, u64)>,
    /// State of its clay besides the pages.
    pub clay: OtherWork,
}

impl SceneJump {
    /// The name of the clays that this jump puts in place.
    pub fn payload_id(&self) -> PayloadId {
        PayloadId::Jump { node: self.node, from: self.from }
    }
}

impl Command {
    /// Returns true if the command owns or shares memory outside its struct. Freeing such a command
    /// may take long.
    pub fn owns_memory(&self) -> bool {
        match self {
            Command::Picture(_)
            | Command::Replace(_)
            | Command::TakeUp(_)
            | Command::Begin(_)
            | Command::Cut(_)
            | Command::Jump(_)
            | Command::MaskRegion(_)
            | Command::ReplaceMasked(..)
            | Command::OfClay(_)
            | Command::Rebased(_)
            | Command::JumpScene(_) => true,
            Command::Scene(scene) => scene.owns_memory(),
            Command::OfPerson(of) => of.command.owns_memory(),
            Command::Brush(_)
            | Command::Camera(_)
            | Command::Undo
            | Command::Redo
            | Command::LiftAll
            | Command::Mask(_)
            | Command::PutDown
            | Command::CalibrateReach
            | Command::Reach(_)
            | Command::Place(_)
            | Command::Reopened
            | Command::OnePerson
            | Command::CurveStroke(_)
            | Command::DesktopLayout(_) => false,
        }
    }

    /// The new clay that this command puts in place, if it does.
    pub fn new_clay_mut(&mut self) -> Option<&mut NewClay> {
        match self {
            Command::Replace(new) | Command::ReplaceMasked(new, _) => Some(new),
            Command::Begin(beginning) => Some(&mut beginning.clay),
            Command::OfPerson(of) => of.command.new_clay_mut(),
            Command::Rebased(rebased) => rebased.command.new_clay_mut(),
            Command::OfClay(of) => match &mut of.command {
                Command::Replace(new) | Command::ReplaceMasked(new, _) => Some(new),
                _ => None,
            },
            _ => None,
        }
    }

    /// Returns true if the command reads or changes the surface of objects, or their list. While an
    /// edit of the whole mask or of face sets is under way, such a command finishes that edit
    /// within its tick. A caller that must meet a deadline holds back such commands, and all that
    /// follow them, until [`crate::world::World::is_in_surface_edit`] is false. The exception is a
    /// command that undoes the edit, see [`crate::world::World::is_taken_back_by`].
    pub fn needs_surface(&self) -> bool {
        match self {
            Command::Brush(_)
            | Command::Camera(_)
            | Command::DesktopLayout(_)
            | Command::CalibrateReach
            | Command::Reach(_)
            | Command::Picture(_)
            | Command::Place(_) => false,
            Command::OfPerson(of) => of.command.needs_surface(),
            _ => true,
        }
    }

    /// Returns true if the command may begin an edit of the whole mask, of face sets or of all
    /// triangles.
    pub fn begins_surface_edit(&self) -> bool {
        match self {
            Command::Mask(_) | Command::MaskRegion(_) => true,
            Command::Scene(
                SceneCommand::Sets(_)
                | SceneCommand::SetsRegion(_)
                | SceneCommand::MaskMeasured(_)
                | SceneCommand::RemeshLocal(_),
            ) => true,
            Command::OfClay(of) => of.command.begins_surface_edit(),
            Command::OfPerson(of) => of.command.begins_surface_edit(),
            _ => false,
        }
    }
}

/// To another node of the history. What it needs is in the session file, under the names given
/// here; whoever sends or replays it fetches that, as the payload [`Jump::payload_id`].
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Jump {
    /// The node's number.
    pub node: u64,
    /// The object and the revision that it was made for: the world ignores it when the object has
    /// changed since.
    pub from: (u32, u64),
    /// The object that the node belongs to.
    pub object_id: u32,
    /// Pages that differ, and their revisions; all of them for another object.
    pub pages: Vec<(u32, u64)>,
    /// State of another object than the one in place, if the jump leads to one.
    pub other: Option<OtherWork>,
}

impl Jump {
    /// The name of the pages or the clay that this jump puts in place.
    pub fn payload_id(&self) -> PayloadId {
        PayloadId::Jump { node: self.node, from: self.from }
    }
}

/// State of an object besides its pages.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct OtherWork {
    /// Page count, revision and the next free numbers of the clay.
    pub rest: ObjectState,
    /// The centre of its bounding box when it was put in place.
    pub middle: glam::Vec3,
    /// Its bounding radius then: the measure of brushes, mirrors and hands.
    pub extent: f32,
    /// The id in the session file of its multiresolution levels, if it has any.
    pub levels: Option<u64>,
}

/// A cut to be made in the clay.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Carving {
    /// Triangles removed and the triangles that replace them.
    pub cut: Arc<Cut>,
    /// The object in the hands is the tool, and gone once the cut is made.
    pub put_down: bool,
}

/// Initial state of a new person's world.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Beginning {
    /// The object.
    pub clay: NewClay,
    /// Before it frames the object.
    pub camera: Camera,
    /// The brush and its settings.
    pub brush: BrushSettings,
}

/// A new object. The sender builds its pages on a separate thread and sends them as the payload
/// `built`. Without that payload the world rebuilds them from the triangles, which takes time
/// proportional to the mesh.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct NewClay {
    /// The triangles.
    pub plain: Arc<TriMesh>,
    /// Keep the camera where it is (a Boolean's result), or frame the new object (a file).
    pub keep_camera: bool,
    /// Its multiresolution levels.
    pub levels: Option<Arc<Levels>>,
    /// The clay of these triangles in the world's store; not part of the bytes.
    #[serde(skip)]
    pub built: Option<PayloadId>,
}

impl NewClay {
    /// A new object without levels, whose clay is not built yet.
    pub fn new(plain: Arc<TriMesh>, keep_camera: bool) -> Self {
        NewClay { plain, keep_camera, levels: None, built: None }
    }
}
