//! Commands to the scene, as plain data.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::{LiveBoolean, ObjectId, ObjectTransform, Operand, Primitive};
use crate::local_remesh::LocalRemesh;
use crate::payload::PayloadId;
use crate::view_region::SetsRegion;
use sculptd_clay::face_sets::{SetsEdit, SetsError};
use sculptd_clay::measured_mask::MeasuredMask;
use sculptd_clay::{LayerEdit, LayerError};
use sculptd_geometry::TriMesh;

/// Objects of a scene, at most.
pub const MAX_OBJECTS: usize = 4096;

/// Something that was asked of the scene. Each that is carried out is one step of undo.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub enum SceneCommand {
    /// An object is added behind the others and made active.
    Add(NewObject),
    /// An object is removed, unless it is the last one or locked. Where it was active, a neighbour
    /// is.
    Remove(ObjectId),
    /// A twin of an object, which shares its pages, is added right behind it and made active.
    Duplicate(ObjectId),
    /// An object gets another name, see [`super::clean_name`].
    Rename(ObjectId, String),
    /// An object stands here from now on.
    Transform(ObjectId, ObjectTransform),
    /// Strokes, masks and Booleans act on this object from now on.
    Activate(ObjectId),
    /// Shows or hides an object. Strokes do not reach a hidden one.
    Show(ObjectId, bool),
    /// Locks or unlocks an object. A locked one is protected from strokes, transforms and removal.
    Lock(ObjectId, bool),
    /// Objects take the place of others: a Boolean, a merge, a split.
    Exchange(Exchange),
    /// An object of a primitive gets other numbers, as long as nothing has changed its clay.
    Reshape(ObjectId, NewObject),
    /// Something is done to the layers of the active object, unless it is locked. Edits of an
    /// intensity that follow each other are one step, see [`LayerEdit::Set`].
    Layers(LayerEdit),
    /// An object is placed flush on a face of another.
    Snap(Box<FlushPlacing>),
    /// Something is done to the face sets of the active object, unless it is locked.
    Sets(SetsEdit),
    /// Something is done to the face sets of what is seen in a region of the view.
    SetsRegion(SetsRegion),
    /// Masks the measured vertices of the active object, in addition to those masked already.
    MaskMeasured(MeasuredMask),
    /// Triangles of the active object get another size: where it was stretched, or what is seen in
    /// a region of the view.
    RemeshLocal(LocalRemesh),
    /// As [`SceneCommand::Transform`], while the object is dragged: together with those before and
    /// after it, it is one step.
    Drag(ObjectId, ObjectTransform),
    /// An object gets another place in the list, 0 the first; beyond the last it is the last.
    Move(ObjectId, u32),
    /// Objects are listed in the group of this name; without one in none. One step.
    Group(Vec<ObjectId>, String),
    /// A face set of the active object gets a name; an empty one takes it away.
    NameSet(u16, String),
    /// As [`SceneCommand::Exchange`] of one new object, which follows its operands from now on.
    ExchangeLive(Box<(Exchange, LiveBoolean)>),
    /// The result of a live Boolean was computed again. It belongs to the step before it.
    Recomputed(Box<Recomputed>),
    /// The result of a live Boolean stays as it is, and the operands go. One step.
    ApplyLive(ObjectId),
}

/// The result of a live Boolean, computed again. Nothing is done where the result no longer follows
/// its operands.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Recomputed {
    /// The result.
    pub id: ObjectId,
    /// The Boolean, with the operands that it was computed from.
    pub live: LiveBoolean,
    /// The recomputed object. Its name and its transform are ignored.
    pub new: NewObject,
}

impl SceneCommand {
    /// The new objects that it brings along.
    pub fn new_objects_mut(&mut self) -> &mut [NewObject] {
        match self {
            SceneCommand::Add(new) | SceneCommand::Reshape(_, new) => std::slice::from_mut(new),
            SceneCommand::Exchange(exchange) => &mut exchange.add,
            SceneCommand::ExchangeLive(exchange) => &mut exchange.0.add,
            SceneCommand::Recomputed(again) => std::slice::from_mut(&mut again.new),
            _ => &mut [],
        }
    }

    /// Returns true if the command owns or shares memory outside its struct.
    pub fn owns_memory(&self) -> bool {
        matches!(
            self,
            SceneCommand::Add(_)
                | SceneCommand::Exchange(_)
                | SceneCommand::Reshape(..)
                | SceneCommand::Rename(..)
                | SceneCommand::Layers(_)
                | SceneCommand::Snap(_)
                | SceneCommand::SetsRegion(_)
                | SceneCommand::MaskMeasured(_)
                | SceneCommand::RemeshLocal(_)
                | SceneCommand::Group(..)
                | SceneCommand::NameSet(..)
                | SceneCommand::ExchangeLive(_)
                | SceneCommand::Recomputed(_)
        ) || matches!(self, SceneCommand::Sets(edit) if edit.owns_memory())
    }
}

/// Source of a new object's shape.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub enum ObjectSource {
    /// Triangles, in the object's own frame.
    Mesh(Arc<TriMesh>),
    /// The numbers of a primitive.
    Primitive(Primitive),
}

/// An object to be added. Its clay is built by whoever asks and sent as a payload; without that the
/// world builds it again, which takes as long as the mesh is large.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct NewObject {
    /// Its name.
    pub name: String,
    /// Source of its shape.
    pub source: ObjectSource,
    /// Its place in the world.
    pub transform: ObjectTransform,
    /// The clay of its source in the world's store; not part of the bytes.
    #[serde(skip)]
    pub built: Option<PayloadId>,
}

impl NewObject {
    /// A new object whose clay is not built yet.
    pub fn new(name: &str, source: ObjectSource, transform: ObjectTransform) -> NewObject {
        NewObject { name: name.into(), source, transform, built: None }
    }
}

/// Objects that take the place of others, in one step.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Exchange {
    /// Its event in the history.
    pub event: SceneEvent,
    /// The objects that the new ones were computed from: nothing is done when one has changed
    /// since.
    pub from: Vec<Operand>,
    /// Of these, the ones that go.
    pub remove: Vec<ObjectId>,
    /// Of these, the ones that stay but are hidden.
    pub hide: Vec<ObjectId>,
    /// Objects to add, at least one; the first of them is active afterwards.
    pub add: Vec<NewObject>,
}

/// An object was placed flush: what the transform was computed from. Nothing is done when one of
/// the two has changed since.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct FlushPlacing {
    /// The object that is moved, as it was.
    pub moved: Operand,
    /// The object that it is put on, as it was.
    pub target: Operand,
    /// New transform of the moved object.
    pub transform: ObjectTransform,
}

/// Kind of scene change, for the history.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum SceneEvent {
    /// An object was added.
    Add,
    /// An object was removed.
    Remove,
    /// An object was duplicated.
    Duplicate,
    /// An object was renamed.
    Rename,
    /// An object was moved, turned or scaled.
    Transform,
    /// Another object was made active.
    Activate,
    /// An object was shown or hidden.
    Show,
    /// An object was locked or unlocked.
    Lock,
    /// A primitive got other numbers.
    Reshape,
    /// A Boolean of two objects.
    Boolean,
    /// Several objects became one.
    Merge,
    /// One object became several.
    Split,
    /// Something was done to the layers of an object.
    Layers,
    /// An object was placed flush on a face of another.
    Snap,
    /// Something was done to the face sets of an object.
    Sets,
    /// Something was done to the whole mask of an object, or to that of a region.
    Mask,
    /// Triangles of an object got another size.
    Remesh,
    /// An object got another place in the list, or another group.
    Arrange,
    /// A face set got a name.
    NameSet,
    /// The result of a live Boolean was computed again.
    Follow,
    /// A live Boolean was applied.
    Apply,
    /// A mirrored twin of an object was added.
    Mirror,
}

/// Why a command to the scene was not carried out. Nothing was changed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum SceneError {
    /// An id that no object has.
    #[error("there is no object {0}")]
    NoObject(ObjectId),
    /// The object is locked.
    #[error("object {0} is locked")]
    Locked(ObjectId),
    /// The last object cannot be removed.
    #[error("the last object cannot be removed")]
    Last,
    /// The scene is full.
    #[error("a scene has at most {MAX_OBJECTS} objects")]
    Full,
    /// A name that is empty or too long.
    #[error("expected a name of 1 to 128 characters")]
    Name,
    /// A transform with values out of range.
    #[error("expected a unit rotation, a scale of 1e-6 to 1e6 and a place within 1e9")]
    Transform,
    /// No clay can be made of the mesh or the numbers.
    #[error("no clay can be made of it")]
    Build,
    /// An operand has changed since the result was computed, or is gone.
    #[error("object {0} has changed meanwhile")]
    Changed(ObjectId),
    /// The clay of a primitive was changed, so its numbers mean nothing any more.
    #[error("object {0} is no primitive, or its clay was changed")]
    NotAPrimitive(ObjectId),
    /// The request for the layers is not possible.
    #[error(transparent)]
    Layers(#[from] LayerError),
    /// The request for the face sets is not possible.
    #[error(transparent)]
    Sets(#[from] SetsError),
    /// The points do not form a region of the view.
    #[error("expected a box, a line of two places, or a polygon of 3 to 1000 corners")]
    Region,
    /// The clay has changed since the mask was measured.
    #[error("the object has changed since its mask was measured")]
    MaskChanged,
    /// The object is hidden, and masks are for what is seen.
    #[error("object {0} is hidden: show it first")]
    Hidden(ObjectId),
    /// A wanted length of edges out of range.
    #[error("expected an edge between a 16th and 16 times of the object's usual one")]
    Edge,
    /// A wanted length of edges that would make too many triangles.
    #[error(
        "expected a longer edge: this one would make more than 8 million new triangles of the \
         whole object, or give it more than 100 million"
    )]
    Fine,
    /// Something that is kept by vertex would have to be given up.
    #[error("the object has layers, which are kept by vertex: flatten them first")]
    KeptByVertex,
    /// An object that is no result of a live Boolean, or no longer.
    #[error("object {0} does not follow any operands: it was changed, or applied")]
    NotLive(ObjectId),
    /// A number that no face set has.
    #[error("expected the number of a face set, 1 to 32767")]
    SetNumber,
    /// An undo took back what was under way.
    #[error("taken back by an undo before it was done")]
    TakenBack,
    /// The active object is another than the one that the result was computed from, or it was
    /// sculpted meanwhile.
    #[error("the sculpture changed while the result was computed")]
    Stale,
    /// A value out of range.
    #[error("expected {0}")]
    Value(&'static str),
    /// The hands hold nothing that could be placed.
    #[error("nothing is held")]
    NothingHeld,
    /// The pages that a jump within the history names were not delivered.
    #[error("the history does not hold this place any more")]
    NotInHistory,
    /// Somebody else's step is in the way of an undo or a redo.
    #[error("somebody else changed the same place since: ask them to undo first")]
    OthersStep,
    /// The loop has more commands waiting than it can take.
    #[error("the loop has more commands waiting than it can take. Try again")]
    Busy,
    /// A command that cannot be shared with others.
    #[error("this cannot be shared with the others at this sculpture")]
    NotShared,
    /// A command of somebody who only looks on.
    #[error("a viewer of a shared sculpture changes nothing: join as a sculptor")]
    LooksOn,
    /// A command with more data than can be shared at once.
    #[error("this is larger than the 8 MiB that can be shared at once")]
    TooLarge,
    /// Too much of this daemon's input is on its way to the others.
    #[error("too much is still on its way to the others: try again when less waits")]
    Congested,
}
