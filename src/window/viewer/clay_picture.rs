//! The pictures of the clay between the panels, one per view: redrawn after a change, else copied.
//! A tooltip, a message or a picture in the history does not redraw the clay.

use std::sync::Arc;

use glam::Vec3;

use super::gpu::clay_target;
use super::preview::Preview;
use super::provisional::ProvisionalDabs;
use super::renderer::LineEnd;
use crate::look::Look;
use sculptd_engine::camera::Camera;
use sculptd_engine::scene::SceneView;

/// All that a picture of the clay is drawn from.
#[derive(Debug, Clone)]
pub(super) struct ClayPictureKey {
    /// The object and its revision.
    pub(super) object: (u32, u64),
    /// All objects, kept so that no other list gets its address.
    pub(super) scene: Arc<SceneView>,
    pub(super) camera: Camera,
    pub(super) look: Look,
    pub(super) brush: Option<(Vec3, f32)>,
    pub(super) lines: Vec<LineEnd>,
    pub(super) led: ProvisionalDabs,
    /// The mesh shown instead of the clay, kept so that no other gets its address.
    pub(super) preview: Option<Arc<Preview>>,
    /// Count the changes of the mesh over the clay, and of the form that shows through it.
    pub(super) overlay: (u64, u64),
    /// Counts the changes of the values of a map.
    pub(super) values: u64,
    /// Pixels.
    pub(super) size: (u32, u32),
}

/// The picture of one view, and what it was drawn from.
#[derive(Debug, Default)]
pub(super) struct ClayPicture {
    texture: Option<wgpu::Texture>,
    /// `None`: it must be redrawn.
    pub(super) key: Option<ClayPictureKey>,
}

impl ClayPicture {
    /// The texture that the view is drawn into, `size` pixels.
    pub(super) fn texture(
        &mut self,
        device: &wgpu::Device,
        format: wgpu::TextureFormat,
        size: (u32, u32),
    ) -> wgpu::Texture {
        let fits = |t: &&wgpu::Texture| (t.width(), t.height()) == size && t.format() == format;
        if let Some(texture) = self.texture.as_ref().filter(fits) {
            return texture.clone();
        }
        let texture = clay_target(device, "clay", size, format);
        (self.texture, self.key) = (Some(texture.clone()), None);
        texture
    }
}

impl PartialEq for ClayPictureKey {
    fn eq(&self, other: &Self) -> bool {
        let same_preview = match (&self.preview, &other.preview) {
            (Some(a), Some(b)) => Arc::ptr_eq(a, b),
            (a, b) => a.is_none() && b.is_none(),
        };
        same_preview
            && self.object == other.object
            && Arc::ptr_eq(&self.scene, &other.scene)
            && self.camera == other.camera
            && self.look == other.look
            && self.brush == other.brush
            && self.lines == other.lines
            && self.led == other.led
            && (self.overlay, self.values, self.size) == (other.overlay, other.values, other.size)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whatever_is_drawn_makes_another_picture() {
        let key = ClayPictureKey {
            object: (1, 2),
            scene: Arc::default(),
            camera: Camera::default(),
            look: Look::default(),
            brush: None,
            lines: Vec::new(),
            led: ProvisionalDabs::default(),
            preview: None,
            overlay: (0, 0),
            values: 0,
            size: (800, 600),
        };
        assert_eq!(key, key.clone());
        let changes: [fn(&mut ClayPictureKey); 8] = [
            |k| k.object.1 += 1,
            |k| k.scene = Arc::default(),
            |k| k.camera.yaw += 0.1,
            |k| k.look.wireframe = true,
            |k| k.brush = Some((Vec3::ZERO, 1.0)),
            |k| k.lines.push(LineEnd::new(Vec3::ZERO, [0; 4])),
            |k| k.values += 1,
            |k| k.size.0 += 1,
        ];
        for change in changes {
            let mut other = key.clone();
            change(&mut other);
            assert_ne!(key, other);
        }
    }
}
