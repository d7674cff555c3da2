//! Takes the small pictures of the steps with the window's own renderer, while the object does not
//! change. Nobody waits for them: the pixels are fetched some polls later.

use std::sync::mpsc;

use super::gpu::clay_target;
use super::objects::{self, Stance};
use super::renderer::{Beside, Scene};
use super::state::WindowState;
use super::step_pictures::PendingPicture;
use crate::look::{Look, Map};
use crate::panels::state::{KEPT, StepPicture};
use sculptd_clay::Snapshot;
use sculptd_daemon::Published;
use sculptd_engine::camera::Camera;

/// Pixels; a row is what copies are padded to.
const SIZE: (u32, u32) = (128, 80);
/// Most triangles of an object that has pictures if a processor draws: each picture costs a frame.
const MOST_ON_A_PROCESSOR: usize = 1_500_000;
/// Time without a change of the object before measuring starts.
const REST_US: u64 = 150_000;
/// Time longer than a pen stays still.
const LONG_REST_US: u64 = 2_000_000;

/// One number for which pages these are: an undo brings old ones back.
fn mark(mesh: &Snapshot) -> u64 {
    mesh.pages().fold(0xcbf2_9ce4_8422_2325u64, |h, p| {
        (h ^ p.revision()).wrapping_mul(0x0000_0100_0000_01b3).rotate_left(29)
    })
}

impl WindowState {
    /// Takes a picture where one is due, and fetches the last; `true` when one has come. Once a
    /// poll.
    pub(super) fn take_step_pictures(&mut self, state: &Published, now: u64) -> bool {
        let fetched = self.fetch();
        let revision = state.mesh.revision();
        let resting_us = now.saturating_sub(self.rested.1);
        let large = self.gpu.software && state.mesh.triangle_count() > MOST_ON_A_PROCESSOR;
        let t = &mut self.step_pictures;
        let (step, ahead) = (state.undo_steps, state.redo_steps);
        // Other clay after as many steps: a stroke that is not done yet, or another object.
        let known =
            t.steps == (step, ahead) && self.ui_state.history.iter().any(|k| k.step == step);
        let rests = resting_us > if known { LONG_REST_US } else { REST_US };
        if t.pending.is_some() || t.seen == Some(revision) || !rests || large {
            return fetched;
        }
        t.seen = Some(revision);
        let (before, before_ahead) = std::mem::replace(&mut t.steps, (step, ahead));
        let mark = mark(&state.mesh);
        let kept = &mut self.ui_state.history;
        if kept.iter().any(|k| k.step == step && k.mark == mark) {
            return fetched;
        }
        if ahead == 0 {
            // The steps ahead are gone; of a full history the oldest steps are.
            kept.retain(|k| k.step < step.max(before + 1));
            if before_ahead == 0 && step <= before {
                let gone = before + 1 - step;
                kept.retain(|k| k.step >= gone);
                kept.iter_mut().for_each(|k| k.step -= gone);
            }
        }
        kept.retain(|k| k.step != step);
        self.take(state, step, mark);
        fetched
    }

    fn take(&mut self, state: &Published, step: usize, mark: u64) {
        let device = &self.gpu.device;
        let size = wgpu::Extent3d { width: SIZE.0, height: SIZE.1, depth_or_array_layers: 1 };
        let format = self.clay_format;
        let texture = self
            .step_pictures
            .target
            .get_or_insert_with(|| clay_target(device, "thumb", SIZE, format));
        let bytes = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("thumb"),
            size: u64::from(SIZE.0 * SIZE.1 * 4),
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        });
        let mut camera = Camera { aspect: SIZE.0 as f32 / SIZE.1 as f32, ..self.camera };
        let (lo, hi) = state.world_bounds();
        if lo.cmple(hi).all() {
            camera.frame(lo, hi);
        }
        let look = Look {
            map: Map::None,
            sets: false,
            wireframe: false,
            grid: false,
            shade: 0.0,
            ..self.ui_state.look
        };
        let others = objects::others(state);
        let scene = Scene {
            mesh: &state.mesh,
            camera: &camera,
            brush: None,
            lines: &[],
            look,
            values: None,
            beside: Beside { stance: Stance::of(state), others: &others, ..Beside::default() },
        };
        let mut encoder = device.create_command_encoder(&Default::default());
        let view = texture.create_view(&Default::default());
        self.renderer.draw(&self.gpu, &mut encoder, &view, SIZE, &scene);
        if self.renderer.waiting > 0 {
            // Not all of the object is on the card yet: another time.
            self.step_pictures.seen = None;
        }
        let layout = wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(SIZE.0 * 4),
            rows_per_image: None,
        };
        let to = wgpu::TexelCopyBufferInfo { buffer: &bytes, layout };
        encoder.copy_texture_to_buffer(texture.as_image_copy(), to, size);
        self.gpu.queue.submit([encoder.finish()]);
        let (done, mapped) = mpsc::channel();
        bytes.slice(..).map_async(wgpu::MapMode::Read, move |r| {
            let _ = done.send(r.is_ok());
        });
        self.step_pictures.pending = Some(PendingPicture { step, mark, bytes, mapped });
    }

    fn fetch(&mut self) -> bool {
        let Some(pending) = &self.step_pictures.pending else { return false };
        let _ = self.gpu.device.poll(wgpu::PollType::Poll);
        let well = match pending.mapped.try_recv() {
            Ok(well) => well,
            Err(mpsc::TryRecvError::Empty) => return false,
            Err(mpsc::TryRecvError::Disconnected) => false,
        };
        let Some(pending) = self.step_pictures.pending.take().filter(|_| well) else {
            return false;
        };
        let Ok(data) = pending.bytes.slice(..).get_mapped_range() else { return false };
        let mut pixels = data.to_vec();
        if matches!(
            self.clay_format,
            wgpu::TextureFormat::Bgra8Unorm | wgpu::TextureFormat::Bgra8UnormSrgb
        ) {
            pixels.chunks_exact_mut(4).for_each(|p| p.swap(0, 2));
        }
        let image =
            egui::ColorImage::from_rgba_unmultiplied([SIZE.0 as usize, SIZE.1 as usize], &pixels);
        let texture = self.egui.egui_ctx().load_texture("thumb", image, Default::default());
        let kept = &mut self.ui_state.history;
        kept.push(StepPicture { step: pending.step, mark: pending.mark, texture });
        kept.sort_by_key(|k| k.step);
        // The farthest from here goes.
        while kept.len() > KEPT {
            let here = self.step_pictures.steps.0;
            let far = (0..kept.len()).max_by_key(|&i| kept[i].step.abs_diff(here)).unwrap_or(0);
            kept.remove(far);
        }
        true
    }
}
