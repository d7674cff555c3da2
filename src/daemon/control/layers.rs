//! What the methods of layers do: they are about the active object.

use super::host::Host;
use super::scene::ask;
use crate::Published;
use sculptd_clay::{LayerEdit, LayerId, LayerStack};
use sculptd_control::RpcError;
use sculptd_control::layers::{LayerAddParams, LayerInfo, LayerReply, LayerSetParams, LayersReply};
use sculptd_engine::scene::SceneCommand;

/// Result of a method that acts on a layer.
pub(super) type LayerDone = Result<LayerReply, RpcError>;

/// The layers of the active object.
pub(super) fn list(shown: &Published) -> LayersReply {
    let none = LayerStack::default();
    let stack = shown.mesh.layers().map_or(&none, |s| s);
    let info = |l: &sculptd_clay::layers::Layer| LayerInfo {
        id: l.id.0,
        name: l.name.clone(),
        intensity: l.intensity,
        visible: l.visible,
    };
    LayersReply {
        object: shown.scene.active().map_or(0, |o| o.id.0),
        layers: stack.layers.iter().map(info).collect(),
        active: stack.active.map(|id| id.0),
        takes_strokes: stack.takes_strokes(),
    }
}

/// Returns the number of layers of the active object.
pub(super) fn count(host: &Host) -> u64 {
    host.published.load().mesh.layers().map_or(0, |s| s.layers.len() as u64)
}

/// Sends an edit to the loop and waits for its result.
pub(super) fn edit(host: &Host, edit: LayerEdit) -> LayerDone {
    let done = ask(host, SceneCommand::Layers(edit))?;
    Ok(LayerReply { layer: (done.id != u32::MAX).then_some(done.id) })
}

pub(super) fn add(host: &Host, p: LayerAddParams) -> LayerDone {
    let count = || host.published.load().mesh.layers().map_or(0, |s| s.next);
    edit(host, LayerEdit::Add(p.name.unwrap_or_else(|| format!("layer {}", count() + 1))))
}

pub(super) fn set(host: &Host, p: LayerSetParams) -> LayerDone {
    let LayerSetParams { layer, intensity, visible, live } = p;
    edit(host, LayerEdit::Set { id: LayerId(layer), intensity, visible, live })
}
