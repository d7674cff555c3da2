//! Every way to change the world that is not a [`sculptd_devices::Sample`]: a panel's click, a
//! control-socket call, a finished Boolean, an undo. Plain data, serialisable;
//! [`crate::world::World::step`] is the only reader.

use std::sync::{Arc, Mutex};

use serde::{Deserialize, Serialize};

use crate::camera::Camera;
use crate::hand::{ReachBox, Similarity};
use crate::stroke::CurveAction;
use sculptd_clay::brush::{BrushSettings, MaskAction, Picture};
use sculptd_clay::{Clay, Cut, Grafted, Levels, ObjectState, Page};
use sculptd_geometry::TriMesh;

#[derive(Debug, Clone, Serialize, Deserialize)]
pub enum Command {
    Brush(BrushSettings),
    Camera(Camera),
    /// Ends every open stroke as a lifted pen does, then takes back the last step.
    Undo,
    Redo,
    /// Ends every open stroke as a lifted pen does.
    LiftAll,
    /// Changes the mask of the whole work: one step of undo.
    Mask(MaskAction),
    /// The picture of heights that brushes with the alpha `picture` press.
    Picture(Arc<Picture>),
    /// Another work takes the place of this one: a file was loaded, a Boolean finished, the kiosk
    /// was reset.
    Replace(NewClay),
    /// The hands take up a thing: a primitive or a loaded mesh, to carry it to its place.
    TakeUp(Arc<TriMesh>),
    /// The thing in the hands is gone: put away, or joined with the work.
    PutDown,
    /// The next five seconds of hands say what the person can reach.
    CalibrateReach,
    /// This part of the tracked space is laid over the work.
    Reach(ReachBox),
    /// Another person's work begins: the world is made anew, and nothing of what was before it
    /// stays.
    Begin(Box<Beginning>),
    /// The thing in the hands stands here.
    Place(Similarity),
    /// A Boolean of a small tool: made where the work around it is as it was when the cut was
    /// computed, else not at all.
    Cut(Carving),
    /// The work becomes what it was at another place of its history, as the session file keeps it.
    Jump(Box<Jump>),
    /// The session was opened again: what could be taken back or done again is in the file alone.
    Reopened,
    /// As [`Command::Replace`], with a mask for each vertex: what made the new work keeps what was
    /// protected so.
    ReplaceMasked(NewClay, Arc<Vec<f32>>),
    /// To the curve that a pen has laid with the method `curve`: drawn, put away, a handle less.
    CurveStroke(CurveAction),
}

/// To another place of the history. What it needs is in the session file, under the names given
/// here, so that a replay finds it again; whoever sends it has fetched it already.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Jump {
    /// The place's number.
    pub node: u64,
    /// The lineage and the revision that it was made for: a work that has changed since takes no
    /// notice.
    pub from: (u32, u64),
    pub object_id: u32,
    /// Pages that differ, and their revisions; all of them for another work.
    pub pages: Vec<(u32, u64)>,
    /// Another work than the one in place.
    pub other: Option<OtherWork>,
    /// Taken by the first `step` that sees it.
    #[serde(skip)]
    pub fetched: Arc<Mutex<Option<Fetched>>>,
}

/// What a work brings along besides its pages.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct OtherWork {
    pub rest: ObjectState,
    /// Its middle and bounding radius: the measure of brushes, mirrors and hands.
    pub middle: glam::Vec3,
    pub extent: f32,
    /// Where its levels are kept, if it has any.
    pub levels: Option<u64>,
}

/// What a jump needs, out of the file.
#[derive(Debug)]
pub enum Fetched {
    Pages(Vec<(u32, Arc<Page>)>),
    Work(Box<Clay>),
}

/// A cut to be made in the work.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Carving {
    pub cut: Arc<Cut>,
    /// The thing in the hands is the tool, and gone once the cut is made.
    pub put_down: bool,
    /// Told what came of it; `None`: the work was changed there in between. Nobody waits for who
    /// asked.
    #[serde(skip)]
    pub answer: Option<crossbeam_channel::Sender<Option<Grafted>>>,
}

/// What a new person's world begins with.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Beginning {
    pub clay: NewClay,
    /// Before it frames the work.
    pub camera: Camera,
    pub brush: BrushSettings,
}

/// A work ready to be put in place. Building the pages is done by whoever asks, on a thread of its
/// own; a replay, which has only the plain triangles, builds them again.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct NewClay {
    pub plain: Arc<TriMesh>,
    /// Keep the camera where it is (a Boolean's result), or frame the new work (a file).
    pub keep_camera: bool,
    /// The other levels of it.
    pub levels: Option<Arc<Levels>>,
    /// Taken by the first `step` that sees it.
    #[serde(skip)]
    built: Arc<Mutex<Option<Clay>>>,
}

impl NewClay {
    pub fn new(plain: Arc<TriMesh>, built: Clay, keep_camera: bool) -> Self {
        NewClay { plain, keep_camera, levels: None, built: Arc::new(Mutex::new(Some(built))) }
    }

    /// The pages, if they were built and not yet taken. Never waits: nobody else holds the lock
    /// once the command is sent.
    pub fn take(&self) -> Option<Clay> {
        self.built.try_lock().ok().and_then(|mut slot| slot.take())
    }
}
