//! Every method of the socket: one declaration binds its name, its parameters, its reply and what
//! it does.
//!
//! From the table below come a type for each method ([`Method`]), the enum [`Request`], the trait
//! [`Handler`] that a server implements (a method without an implementation does not compile), and
//! the list [`METHODS`].

use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::{Value, json};

use crate::brush::{
    BrushSettings, BrushesReply, CurveParams, CurveReply, MaskMeasuredParams, MaskMeasuredReply,
    MaskParams, MaskRegionParams, PathParams, PictureReply, StrokeParams, StrokeReply,
};
use crate::check;
use crate::edit::{
    BooleanParams, BooleanReply, CancelReply, ExportReply, HashReply, HistoryReply, JoinParams,
    JumpParams, LevelParams, LevelReply, LoadReply, ProgressReply, RemeshParams, RemeshReply,
    TakeUpReply, ThicknessParams, ThicknessReply, TrimParams,
};
use crate::event::SubscribeReply;
use crate::face_sets::{
    FaceSetExtractParams, FaceSetMakeParams, FaceSetNameParams, FaceSetParams, FaceSetRegionParams,
    FaceSetReply, FaceSetShowParams, FaceSetsReply,
};
use crate::guests::{
    GuestInviteParams, GuestLink, GuestRevokeParams, GuestRevokeReply, GuestsReply,
};
use crate::layers::{
    LayerActivateParams, LayerAddParams, LayerMoveParams, LayerParams, LayerRenameParams,
    LayerReply, LayerSetParams, LayersReply,
};
use crate::people::PeopleReply;
use crate::repair::{RepairParams, RepairReply};
use crate::retopology::{
    DecimateParams, DecimateReply, RemeshLocalParams, RemeshLocalReply, RemeshQuadsParams,
    RemeshQuadsReply, SymmetriseParams, SymmetriseReply,
};
use crate::scene::{
    AddParams, CombineReply, ExportParams, GroupParams, LockParams, MergeParams, MirrorParams,
    MoveParams, ObjectParams, ObjectReply, RenameParams, ReshapeParams, SceneBooleanParams,
    SceneReply, ShowParams, TransformParams,
};
use crate::snap::{SnapParams, SnapReply};
use crate::status::{
    HelloParams, HelloReply, MethodsReply, NoParams, SentReply, ShutdownReply, StatusParams,
    StatusReply, WindowParams, WindowReply,
};
use crate::view::{CameraSettings, ReachParams, ReachReply};
use crate::wire::{Code, Envelope, RpcError};

/// A method, as a type: what it is called, what it takes, what it answers.
pub trait Method {
    /// Its name on the line.
    const NAME: &'static str;
    /// Its description, for people.
    const ABOUT: &'static str;
    /// Its parameters.
    type Params: Serialize + DeserializeOwned;
    /// Its reply.
    type Reply: Serialize + DeserializeOwned;
}

/// A method's name and what it does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct MethodInfo {
    /// Its name on the line.
    pub name: &'static str,
    /// Its description, for people.
    pub about: &'static str,
}

/// Methods that are answered even while every other place is taken.
pub const ALWAYS_ANSWERED: [&str; 2] = [Shutdown::NAME, Cancel::NAME];

macro_rules! methods {
    ($(
        $(#[doc = $about:literal])+
        $name:literal $variant:ident $handler:ident($params:ty) -> $reply:ty;
    )+) => {
        $(
            $(#[doc = $about])+
            #[derive(Debug, Clone, Copy, PartialEq, Eq)]
            pub struct $variant;

            impl Method for $variant {
                const NAME: &'static str = $name;
                const ABOUT: &'static str = concat!($($about),+).trim_ascii();
                type Params = $params;
                type Reply = $reply;
            }
        )+

        /// Every method, in the order of the table.
        pub const METHODS: &[MethodInfo] =
            &[$(MethodInfo { name: $name, about: $variant::ABOUT }),+];

        /// A request whose parameters were read and checked.
        #[derive(Debug, Clone, PartialEq)]
        #[allow(clippy::large_enum_variant)]
        pub enum Request {
            $($(#[doc = $about])+ $variant($params),)+
        }

        impl Request {
            /// The name of its method.
            pub fn name(&self) -> &'static str {
                match self { $(Request::$variant(_) => $name,)+ }
            }

            /// Reads a request.
            ///
            /// # Errors
            /// [`Code::NoMethod`] for a name that is not in [`METHODS`]; [`Code::BadParams`] for a
            /// parameter that is missing, unknown, of another type, or out of its range, with the
            /// field, the value and the range.
            ///
            /// ```
            /// use sculptd_control::Request;
            /// let e = Request::read("camera", serde_json::json!({ "pitch": 9 })).unwrap_err();
            /// assert_eq!(e.code, -32602);
            /// assert_eq!(e.message, "pitch = 9: expected a number from -1.553343 to 1.553343");
            /// ```
            pub fn read(method: &str, params: Value) -> Result<Request, RpcError> {
                match method {
                    $($name => read_params::<$params>($name, params).map(Request::$variant),)+
                    _ => Err(RpcError::new(
                        Code::NoMethod,
                        format!("no method '{method}'; 'methods' lists them"),
                    )),
                }
            }

            /// The request as it is sent.
            ///
            /// # Errors
            /// A parameter has no JSON form (a path that is not UTF-8).
            pub fn envelope(&self, id: u64) -> serde_json::Result<Envelope> {
                match self {
                    $(Request::$variant(p) => {
                        Ok(Envelope::new(id, $name, serde_json::to_value(p)?))
                    })+
                }
            }
        }

        /// Handler of requests: one function per method.
        pub trait Handler {
            $($(#[doc = $about])+
            ///
            /// # Errors
            /// The request cannot be carried out; the text says why.
            fn $handler(&self, params: $params) -> Result<$reply, RpcError>;)+
        }

        /// Carries out a request.
        ///
        /// # Errors
        /// The error of the handler, or a reply that has no JSON form.
        pub fn answer<H: Handler + ?Sized>(
            handler: &H,
            request: Request,
        ) -> Result<Value, RpcError> {
            match request {
                $(Request::$variant(params) => to_value(&handler.$handler(params)?),)+
            }
        }

        /// The schema of every method's parameters and reply, by its name.
        #[cfg(test)]
        pub(crate) fn schemas(
            generator: &mut schemars::SchemaGenerator,
        ) -> Vec<(MethodInfo, schemars::Schema, schemars::Schema)> {
            let mut all = Vec::with_capacity(METHODS.len());
            $(all.push((
                MethodInfo { name: $name, about: $variant::ABOUT },
                generator.subschema_for::<$params>(),
                generator.subschema_for::<$reply>(),
            ));)+
            all
        }
    };
}

methods! {
    /// Agrees on a version: the newest that both sides speak.
    "hello" Hello hello(HelloParams) -> HelloReply;
    /// Lists every method and what it does.
    "methods" Methods methods(NoParams) -> MethodsReply;
    /// The loop's figures, the mesh, the brush, the session file and what is wrong with it.
    "status" Status status(StatusParams) -> StatusReply;
    /// Changes the named settings of the brush, and answers with all.
    "brush" Brush brush(BrushSettings) -> BrushSettings;
    /// Lists every brush: its description, its settings, its special numbers.
    "brushes" Brushes brushes(NoParams) -> BrushesReply;
    /// Loads a picture of heights (PNG, TIFF, EXR), for brushes with the alpha `picture`.
    "picture" Picture picture(PathParams) -> PictureReply;
    /// Changes the mask of the whole object.
    "mask" Mask mask(MaskParams) -> SentReply;
    /// Masks what is thin, or sheltered from light, beside what is masked already: one step.
    "mask-measured" MaskMeasured mask_measured(MaskMeasuredParams) -> MaskMeasuredReply;
    /// Sets the mask of what is seen in a box, to the left of a line, or in a polygon.
    "mask-region" MaskRegion mask_region(MaskRegionParams) -> SentReply;
    /// Applies, discards or edits the curve that a pen has laid.
    "curve" Curve curve(CurveParams) -> CurveReply;
    /// Makes a stroke, as a pen would.
    "stroke" Stroke stroke(StrokeParams) -> StrokeReply;
    /// Who shares the sculpture: names, roles, colours, and where their pens meet the clay.
    "people" People people(NoParams) -> PeopleReply;
    /// Lists the guests who joined in a browser, and the links by which guests join.
    "guests.list" GuestsList guests_list(NoParams) -> GuestsReply;
    /// Makes a link by which guests join in a browser.
    "guests.invite" GuestsInvite guests_invite(GuestInviteParams) -> GuestLink;
    /// Revokes a link: the guests who joined by it are disconnected.
    "guests.revoke" GuestsRevoke guests_revoke(GuestRevokeParams) -> GuestRevokeReply;
    /// Changes the named settings of the camera, and answers with all.
    "camera" Camera camera(CameraSettings) -> CameraSettings;
    /// Undoes one step; of a shared sculpture the person's newest step, unless somebody else has
    /// since changed the same part: `people` reports who.
    "undo" Undo undo(NoParams) -> SentReply;
    /// Redoes the step that was undone last; of a shared sculpture as `undo`.
    "redo" Redo redo(NoParams) -> SentReply;
    /// Every node of the history, branches too, as the session file keeps them.
    "history" History history(NoParams) -> HistoryReply;
    /// Goes to a node of the history.
    "jump" Jump jump(JumpParams) -> SentReply;
    /// Replaces the object by a mesh from a file of at most 1 GiB.
    "load" Load load(PathParams) -> LoadReply;
    /// Writes the visible objects, or the named ones, to a file; the extension selects the format.
    "export" Export export(ExportParams) -> ExportReply;
    /// One number over all objects.
    "hash" Hash hash(NoParams) -> HashReply;
    /// Wall thickness of the object, as `sculptd thickness` measures a file.
    "thickness" Thickness thickness(ThicknessParams) -> ThicknessReply;
    /// Puts a mesh from a file of at most 1 GiB into the hands, to be carried to its place.
    "take-up" TakeUp take_up(PathParams) -> TakeUpReply;
    /// Removes what the hands hold.
    "put-down" PutDown put_down(NoParams) -> SentReply;
    /// A Boolean of the object and what the hands hold.
    "join" Join join(JoinParams) -> BooleanReply;
    /// Cuts off what is seen in a box, or to the left of a line.
    "trim" Trim trim(TrimParams) -> BooleanReply;
    /// Shows the object one level finer or coarser; what was sculpted on finer levels is kept.
    "level" Level level(LevelParams) -> LevelReply;
    /// Gives the object one closed surface of even triangles: one step of undo. Shells that overlap
    /// are united; masks and colours are carried over.
    "remesh" Remesh remesh(RemeshParams) -> RemeshReply;
    /// Gives the object quads that follow the shape, its creases and guide lines, or makes them the
    /// lowest of several levels: one step of undo. Masks and colours are carried over.
    "remesh.quads" RemeshQuads remesh_quads(RemeshQuadsParams) -> RemeshQuadsReply;
    /// Gives triangles one size, either where the surface was stretched or in a region of the view:
    /// one step of undo. Masked, hidden and border vertices stay; face sets, masks and colours are
    /// kept. An object with layers is refused. An `undo` meanwhile cancels it at once, and it
    /// returns an error.
    "remesh.local" RemeshLocal remesh_local(RemeshLocalParams) -> RemeshLocalReply;
    /// Leaves as few triangles as are wanted, for printing and the web: one step of undo.
    /// New crossings are undone where they can be and counted, and the border of the mask stays.
    "decimate" Decimate decimate(DecimateParams) -> DecimateReply;
    /// Replaces one side of a plane through the middle of the object, which must be a solid, by the
    /// mirror image of the other: one step of undo.
    "symmetrise" Symmetrise symmetrise(SymmetriseParams) -> SymmetriseReply;
    /// Repairs the object for printing or moulding, then checks it again: a flat base, a split with
    /// pegs and sockets, drain holes, vents, draft, thicker walls, or text. One step of undo.
    "repair" Repair repair(RepairParams) -> RepairReply;
    /// A Boolean of the object and a mesh from a file of at most 1 GiB, moved by `at`.
    "boolean" Boolean boolean(BooleanParams) -> BooleanReply;
    /// Every object of the scene, and which is active.
    "scene.list" SceneList scene_list(NoParams) -> SceneReply;
    /// Adds a primitive or a mesh from a file, and makes it active.
    "scene.add" SceneAdd scene_add(AddParams) -> ObjectReply;
    /// Removes an object, unless it is the last one or locked.
    "scene.remove" SceneRemove scene_remove(ObjectParams) -> ObjectReply;
    /// Adds a twin of an object, and makes it active.
    "scene.duplicate" SceneDuplicate scene_duplicate(ObjectParams) -> ObjectReply;
    /// Gives an object another name.
    "scene.rename" SceneRename scene_rename(RenameParams) -> ObjectReply;
    /// Moves, turns and scales an object. Its mesh stays as it is, to the bit.
    "scene.transform" SceneTransform scene_transform(TransformParams) -> ObjectReply;
    /// Makes an object the one that strokes and Booleans act on.
    "scene.activate" SceneActivate scene_activate(ObjectParams) -> ObjectReply;
    /// Shows or hides an object.
    "scene.show" SceneShow scene_show(ShowParams) -> ObjectReply;
    /// Protects an object from strokes, transforms and removal, or no longer.
    "scene.lock" SceneLock scene_lock(LockParams) -> ObjectReply;
    /// Gives a primitive other numbers, until its first stroke.
    "scene.reshape" SceneReshape scene_reshape(ReshapeParams) -> ObjectReply;
    /// Places an object flush on a face of another: the two faces share a plane and face each
    /// other.
    "scene.snap" SceneSnap scene_snap(SnapParams) -> SnapReply;
    /// A Boolean of two objects, where they stand. The result is a new object.
    "scene.boolean" SceneBoolean scene_boolean(SceneBooleanParams) -> CombineReply;
    /// Ends that the result of a Boolean follows its operands: they go, and it stays as it is.
    "scene.apply" SceneApply scene_apply(ObjectParams) -> ObjectReply;
    /// Adds a mirrored twin of an object, in a plane through the origin of the world.
    "scene.mirror" SceneMirror scene_mirror(MirrorParams) -> CombineReply;
    /// Puts an object at another place of the list.
    "scene.move" SceneMove scene_move(MoveParams) -> ObjectReply;
    /// Lists objects in a group, or in none.
    "scene.group" SceneGroup scene_group(GroupParams) -> ObjectReply;
    /// Makes several objects one, whose parts may overlap.
    "scene.merge" SceneMerge scene_merge(MergeParams) -> CombineReply;
    /// Splits each connected part of an object into a separate object.
    "scene.split" SceneSplit scene_split(ObjectParams) -> CombineReply;
    /// The layers of the active object, from the lowest up.
    "layers.list" LayersList layers_list(NoParams) -> LayersReply;
    /// Adds a layer above the others, and makes it the one that strokes change.
    "layers.add" LayersAdd layers_add(LayerAddParams) -> LayerReply;
    /// Removes a layer with what it does.
    "layers.remove" LayersRemove layers_remove(LayerParams) -> LayerReply;
    /// Gives a layer another name.
    "layers.rename" LayersRename layers_rename(LayerRenameParams) -> LayerReply;
    /// Puts a layer at another place in the order.
    "layers.move" LayersMove layers_move(LayerMoveParams) -> LayerReply;
    /// Sets the intensity of a layer, shows or hides it.
    "layers.set" LayersSet layers_set(LayerSetParams) -> LayerReply;
    /// Makes a layer, or the base, the one that strokes change.
    "layers.activate" LayersActivate layers_activate(LayerActivateParams) -> LayerReply;
    /// Adds a layer to the one below it, or to the base. Neither may be hidden.
    "layers.merge" LayersMerge layers_merge(LayerParams) -> LayerReply;
    /// Adds a hidden twin of a layer right above it, and makes it the one that strokes change.
    "layers.duplicate" LayersDuplicate layers_duplicate(LayerParams) -> LayerReply;
    /// Takes away what a layer does; the layer stays.
    "layers.clear" LayersClear layers_clear(LayerParams) -> LayerReply;
    /// Makes the surface as it is the base, without layers.
    "layers.bake" LayersBake layers_bake(NoParams) -> LayerReply;
    /// Gives a face set a name, or takes it away.
    "sets.rename" SetsRename sets_rename(FaceSetNameParams) -> FaceSetReply;
    /// The face sets of the active object, and how much of it is hidden.
    "sets.list" SetsList sets_list(NoParams) -> FaceSetsReply;
    /// Makes face sets from the mask, from what is shown, or by the shape: one step of undo.
    "sets.make" SetsMake sets_make(FaceSetMakeParams) -> FaceSetReply;
    /// Clears all face sets. Hidden vertices stay hidden.
    "sets.clear" SetsClear sets_clear(NoParams) -> FaceSetReply;
    /// Hides a face set, or what is masked: it is not drawn, not hit by pens and not changed by
    /// brushes. Exports keep it.
    "sets.hide" SetsHide sets_hide(FaceSetParams) -> FaceSetReply;
    /// Shows a face set again, or everything.
    "sets.show" SetsShow sets_show(FaceSetShowParams) -> FaceSetReply;
    /// Hides what is shown, and shows what is hidden.
    "sets.invert" SetsInvert sets_invert(NoParams) -> FaceSetReply;
    /// Hides all but one face set.
    "sets.isolate" SetsIsolate sets_isolate(FaceSetParams) -> FaceSetReply;
    /// Makes a face set of what is seen in a region of the view, all the way through, or hides it,
    /// or hides all but it: one step of undo.
    "sets.region" SetsRegion sets_region(FaceSetRegionParams) -> FaceSetReply;
    /// Adds an object: what is masked, or a face set, as a closed shell of a thickness.
    "sets.extract" SetsExtract sets_extract(FaceSetExtractParams) -> ObjectReply;
    /// Reports the progress of the Boolean under way.
    "progress" Progress progress(NoParams) -> ProgressReply;
    /// Ends the Boolean that is under way; nothing is changed.
    "cancel" Cancel cancel(NoParams) -> CancelReply;
    /// Lays this part of the tracked space over the object, or measures it for five seconds.
    "reach" Reach reach(ReachParams) -> ReachReply;
    /// From now on sends a line for each change of mesh, history, brush, losses or session file.
    "subscribe" Subscribe subscribe(NoParams) -> SubscribeReply;
    /// Opens a new window if the daemon has none. The daemon restarts with the same session, so its
    /// connections are closed and its socket is away for a moment.
    "window" Window window(WindowParams) -> WindowReply;
    /// Ends the daemon as a signal would.
    "shutdown" Shutdown shutdown(NoParams) -> ShutdownReply;
}

fn read_params<T: DeserializeOwned>(method: &str, params: Value) -> Result<T, RpcError> {
    let params = if params.is_null() { json!({}) } else { params };
    if !params.is_object() {
        return Err(RpcError::bad_params("expected an object"));
    }
    check::check_params(method, &params)?;
    T::deserialize(&params).map_err(|e| RpcError::bad_params(check::in_plain_words(&params, &e)))
}

fn to_value<T: Serialize>(reply: &T) -> Result<Value, RpcError> {
    serde_json::to_value(reply).map_err(|e| RpcError::failed(e.to_string()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_method_refuses_an_unknown_parameter_and_a_list() {
        for m in METHODS.iter().filter(|m| m.name != Brush::NAME) {
            for params in [json!({ "no such parameter": 1 }), json!([1])] {
                let e = Request::read(m.name, params).expect_err(m.name);
                assert_eq!(e.code, Code::BadParams as i32, "{}: {}", m.name, e.message);
            }
        }
        let e = Request::read("frobnicate", Value::Null).expect_err("unknown");
        assert_eq!(e.code, Code::NoMethod as i32);
    }

    #[test]
    fn a_request_comes_back_from_its_envelope() {
        let request = Request::read("boolean", json!({ "operation": "union", "path": "/a.stl" }));
        let request = request.expect("fine");
        let sent = request.envelope(1).expect("JSON");
        assert_eq!(Request::read(&sent.method, sent.params), Ok(request));
    }

    #[test]
    fn the_boolean_has_one_vocabulary_and_version_1_still_reads() {
        let read = |word: &str| Request::read("join", json!({ "operation": word }));
        for word in ["union", "intersection", "difference", "reverse-difference"] {
            assert!(read(word).is_ok(), "{word}");
        }
        assert_eq!(read("carve"), read("difference"));
        assert_eq!(read("add"), read("union"));
        assert_eq!(read("keep"), read("intersection"));
        let e = read("ball").expect_err("not an operation");
        assert!(e.code == -32602 && e.message.contains("ball") && e.message.contains("union"));
    }

    #[test]
    fn numbers_out_of_range_are_refused_by_field_value_and_range() {
        let refused = |method: &str, params: Value| {
            let e = Request::read(method, params.clone()).expect_err(&params.to_string());
            assert_eq!(e.code, Code::BadParams as i32);
            e.message
        };
        let at = json!({ "operation": "union", "path": "/a.stl", "at": [0, 1e308, 0] });
        let said = refused("boolean", at);
        assert!(said == "at[1] = 1e+308: expected a number from -1000000 to 1000000", "{said}");
        let said = refused("camera", json!({ "target": [0, 0, 1e38] }));
        assert!(said.starts_with("target[2] = 1e+38: expected"), "{said}");
        let said = refused("mask", json!({ "action": { "cavity": -1 } }));
        assert_eq!(said, "action.cavity = -1: expected a number from 0 to 1");
        let said = refused("scene.add", json!({ "primitive": "box" }));
        assert!(
            said.starts_with("primitive = \"box\": expected one of {\"box\": [x, y, z]}"),
            "{said}"
        );
        for (method, params) in [
            ("camera", json!({ "distance": 0 })),
            ("camera", json!({ "yaw": 1e38 })),
            ("thickness", json!({ "rays": 0 })),
            ("thickness", json!({ "rays": 1001 })),
            ("thickness", json!({ "near": [1e300, 0, 0] })),
            ("reach", json!({ "middle_mm": [0, 2000, 0], "half_mm": 100 })),
            ("reach", json!({ "middle_mm": [0, 0, 0], "half_mm": 1 })),
            ("trim", json!({ "part": { "box": [0, 0, 1, 11] } })),
            ("trim", json!({ "part": { "line": [0, 0, 1e39, 1] } })),
            ("jump", json!({ "node": -1 })),
            ("curve", json!({ "act": { "delete": 70000 } })),
            ("load", json!({ "path": "" })),
            ("load", json!({ "path": format!("/{}", "x".repeat(5000)) })),
            ("stroke", json!({ "points": [], "space": "view" })),
            ("stroke", json!({ "points": [[0, 0, 0.5, 1e9]], "space": "view" })),
        ] {
            refused(method, params);
        }
        assert!(Request::read("mask", json!({ "action": { "cavity": 1 } })).is_ok());
        assert!(Request::read("camera", json!({ "pitch": 1.5, "yaw": null })).is_ok());
    }
}
