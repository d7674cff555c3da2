//! The clay of one frame: each view is drawn into a picture of its size, which is then copied to
//! its place. An unchanged view is only copied.
//!
//! All views are drawn one after another from the same pages on the card. The numbers of a frame
//! share one buffer, so each view is submitted before the next one's numbers are written.

use glam::Vec3;

use super::clay_picture::ClayPictureKey;
use super::objects::{self, Stance};
use super::pages::MapValues;
use super::provisional::ProvisionalDabs;
use super::renderer::{Beside, LineEnd, Scene};
use super::state::WindowState;
use crate::look::Map;
use crate::panels::state::{UiState, ViewKind};
use sculptd_daemon::Published;
use sculptd_engine::camera::Camera;

/// Content drawn over the clay of one view.
#[derive(Debug, Default)]
pub(super) struct OverClay {
    pub(super) lines: Vec<LineEnd>,
    /// The brush's place and radius.
    pub(super) brush: Option<(Vec3, f32)>,
    /// Dabs that a pen will have raised when the frame is seen.
    pub(super) led: ProvisionalDabs,
}

impl WindowState {
    /// The clay in the part of the window that the panels leave free; `worked_in`: what lies over
    /// it in the view in which is worked.
    pub(super) fn draw_clay(
        &mut self,
        state: &Published,
        worked_in: OverClay,
        encoder: &mut wgpu::CommandEncoder,
        surface: &wgpu::Texture,
    ) {
        (self.uploaded, self.clay_waits) = (0, false);
        let active = self.views.active();
        let mut worked_in = Some(worked_in);
        for &kind in self.views.shown() {
            let camera = self.views.camera(kind, &self.camera);
            let over = worked_in.take_if(|_| kind == active);
            let over = over.unwrap_or_else(|| self.over_other_view(state, &camera));
            let (corner, size) = self.part_of(kind);
            let size = (size.x as u32, size.y as u32);
            if !self.takes_copies() {
                self.draw_view(state, (kind, camera), over, encoder, surface, size);
                continue;
            }
            let picture = &mut self.clay_pictures[kind as usize];
            let target = picture.texture(&self.gpu.device, self.clay_format, size);
            if self.views.are_four() {
                let mut own = self.gpu.device.create_command_encoder(&Default::default());
                self.draw_view(state, (kind, camera), over, &mut own, &target, size);
                self.gpu.queue.submit([own.finish()]);
            } else {
                self.draw_view(state, (kind, camera), over, encoder, &target, size);
            }
            let mut to = surface.as_image_copy();
            to.origin = wgpu::Origin3d { x: corner.x as u32, y: corner.y as u32, z: 0 };
            let extent = wgpu::Extent3d { width: size.0, height: size.1, depth_or_array_layers: 1 };
            encoder.copy_texture_to_texture(target.as_image_copy(), to, extent);
        }
        for kind in ViewKind::ALL {
            if !self.views.shown().contains(&kind) {
                self.clay_pictures[kind as usize] = Default::default();
            }
        }
    }

    /// Draws one view into `target`, where anything of it has changed.
    fn draw_view(
        &mut self,
        state: &Published,
        (kind, mut camera): (ViewKind, Camera),
        over: OverClay,
        encoder: &mut wgpu::CommandEncoder,
        target: &wgpu::Texture,
        size: (u32, u32),
    ) {
        let pages = state.mesh.page_count();
        let first = self.first_picture.as_ref().filter(|p| p.pages == pages);
        if let Some((lo, hi)) = first.and_then(|p| p.bounds) {
            camera.frame(lo, hi);
        }
        let lines = if first.is_some() { Vec::new() } else { over.lines };
        let brush = over.brush.filter(|_| first.is_none());
        let backdrop = match first {
            // The backdrop belongs to one camera.
            None if kind == ViewKind::Free || !self.views.are_four() => self.backdrop(),
            _ => 0.0,
        };
        let preview = first.or(self.preview.as_ref());
        let key = ClayPictureKey {
            object: state.clay_revision(),
            scene: state.scene.clone(),
            camera,
            look: self.ui_state.look,
            brush,
            lines,
            led: over.led,
            preview: preview.cloned(),
            overlay: (self.overlay_mesh.stamp, self.ghost.triangles.stamp),
            values: self.map_changes,
            size,
        };
        let part = self.takes_copies();
        if part && self.clay_pictures[kind as usize].key.as_ref() == Some(&key) {
            return;
        }
        let others = objects::others(state);
        let scene = Scene {
            mesh: &state.mesh,
            camera: &camera,
            brush,
            lines: &key.lines,
            look: self.ui_state.look,
            values: shown(&self.ui_state, [&self.values, &self.distances, &self.wall_changes])
                .filter(|v| v.pages.len() == pages),
            beside: Beside {
                preview,
                overlay: Some(&self.overlay_mesh),
                ghost: self.ghost.shown(),
                stance: Stance::of(state),
                others: &others,
                led: Some(&key.led),
                backdrop,
            },
        };
        let view = target.create_view(&Default::default());
        self.renderer.draw(&self.gpu, encoder, &view, size, &scene);
        self.uploaded += self.renderer.uploaded;
        // A picture that lacks pages is drawn again.
        let waits = self.renderer.waiting > 0;
        self.clay_waits |= waits;
        self.clay_pictures[kind as usize].key = (part && !waits).then_some(key);
    }

    /// Marks all views to be redrawn.
    pub(super) fn forget_clay(&mut self) {
        for picture in &mut self.clay_pictures {
            picture.key = None;
        }
    }
}

/// The values of the map that is shown.
pub(super) fn shown<'a>(
    ui_state: &UiState,
    [thickness, distances, wall_changes]: [&'a Option<MapValues>; 3],
) -> Option<&'a MapValues> {
    match ui_state.look.map {
        Map::Distance => distances.as_ref(),
        Map::WallChange => wall_changes.as_ref(),
        _ => thickness.as_ref(),
    }
}
