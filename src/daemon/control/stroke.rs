//! A stroke as a request: its points become samples of a virtual pen, which take the same way as
//! those of a tablet. So they are recorded, replayed and bounded like any other.

use std::sync::Arc;
use std::time::Duration;

use glam::{Vec2, Vec3};

use super::loop_link::LoopLink;
use crate::Published;
use crate::adaptors::CONTROL_PEN_ID;
use crate::people::SharedState;
use sculptd_clay::brush::{BrushSettings, Picture};
use sculptd_control::RpcError;
use sculptd_control::brush::{StrokeParams, StrokePoint, StrokeReply};
use sculptd_devices::queue::{Sender, SenderFactory};
use sculptd_devices::{Body, Clock, Pen, Sample, Tool};
use sculptd_engine::command::Command;
use sculptd_engine::scene::SceneError;

/// Size of the virtual pen's active area, mm: the view's height, and its width by the aspect.
const AREA_MM: f32 = 200.0;
/// Longest wait for the loop to take what was sent and to lay every dab of it.
const PATIENCE: Duration = Duration::from_secs(60);
/// Longest wait for a daemon that is cut off from a shared sculpture: longer than a successor of a
/// lost host needs.
const CUT_OFF: Duration = Duration::from_secs(5);
/// Between two looks at the loop.
const LOOK: Duration = Duration::from_millis(1);
/// A point in space is seen where the first surface on the line of sight is no further from it than
/// so many radii of the brush.
const SEEN_WITHIN: f32 = 1.0;

/// The pen whose samples `stroke` sends.
#[derive(Debug)]
pub struct VirtualPen {
    sender: Sender,
    clock: Clock,
}

/// A brush for one stroke.
#[derive(Debug)]
pub struct LentBrush {
    /// Settings for the stroke.
    pub settings: BrushSettings,
    /// The height picture of the brush.
    pub picture: Option<Arc<Picture>>,
    /// Settings to restore for a brush of this kind afterwards, if it is not the one in hand.
    pub kept: Option<BrushSettings>,
}

/// Returns a flat picture of height 0, which acts as if there were none.
fn no_picture() -> Arc<Picture> {
    Arc::new(Picture { width: 1, height: 1, heights: vec![0], cover: Vec::new() })
}

impl VirtualPen {
    /// Creates a pen on the loop's channel. `clock` is the loop's clock.
    pub fn new(factory: &SenderFactory, clock: Clock) -> Self {
        VirtualPen { sender: factory.sender(), clock }
    }

    /// Makes the stroke in the time that its points say, and waits until the loop has taken it.
    /// `brush`: the brush to make it with, instead of the one in hand.
    ///
    /// # Errors
    /// A point in space that is not seen, and a loop that takes nothing.
    pub fn draw(
        &mut self,
        link: LoopLink<'_>,
        stroke: &StrokeParams,
        brush: Option<LentBrush>,
    ) -> Result<StrokeReply, RpcError> {
        let shown = link.published.load_full();
        if shown.looks_on() {
            return Err(RpcError::failed(SceneError::LooksOn.to_string()));
        }
        let points = in_view(&shown, stroke)?;
        if let Some(lent) = &brush {
            if let Some(picture) = &lent.picture {
                link.carry_out(Command::Picture(picture.clone()))?;
            }
            link.carry_out(Command::Brush(lent.settings))?;
        }
        let drawn = self.send_samples(link, &points, shown.camera.aspect);
        if let Some(lent) = brush {
            // Whatever came of it: the brush in hand is the person's, and so are the picture and
            // what the other brush was set to. A stroke that follows finds them in place.
            if lent.picture.is_some() {
                link.carry_out(Command::Picture(shown.picture.clone().unwrap_or_else(no_picture)))?;
            }
            if let Some(kept) = lent.kept {
                link.carry_out(Command::Brush(kept))?;
            }
            link.carry_out(Command::Brush(shown.brush))?;
        }
        drawn
    }

    fn send_samples(
        &mut self,
        link: LoopLink<'_>,
        points: &[ViewPoint],
        aspect: f32,
    ) -> Result<StrokeReply, RpcError> {
        let area = Vec2::new(AREA_MM * aspect, AREA_MM);
        let begun = self.clock.now_us();
        let pen = |at: &ViewPoint, touches: bool| Pen {
            tool: Tool::Pen,
            in_range: touches,
            tip: touches,
            pos_mm: at.view * area,
            area_mm: area,
            pressure: Some(if touches { at.pressure } else { 0.0 }),
            ..Pen::default()
        };
        let Some(last) = points.last() else {
            return Err(RpcError::bad_params("points is empty"));
        };
        let quiet = crossbeam_channel::never::<()>();
        for at in points {
            let due = begun + at.t_us;
            while self.clock.now_us() < due && !link.stopped() {
                let left = Duration::from_micros(due.saturating_sub(self.clock.now_us()));
                let _ = quiet.recv_timeout(left.min(Duration::from_millis(50)));
            }
            if link.stopped() {
                break;
            }
            self.push(pen(at, true));
        }
        // A stroke always ends, even where the daemon stops in the middle of it.
        self.push(pen(last, false));
        let give_up = self.clock.now_us() + PATIENCE.as_micros() as u64;
        while !self.sender.flush() {
            if link.stopped() || self.clock.now_us() > give_up {
                return Err(not_taken());
            }
            let _ = quiet.recv_timeout(LOOK);
        }
        let mut tick = self.await_tick(link)?;
        let shown = link.published.load_full();
        if shown.standing.state != SharedState::NotShared {
            // In the order of everybody's input the command comes after the stroke: once it is
            // carried out, the stroke is made.
            let done = link.commands.carry_out(Command::Brush(shown.brush), PATIENCE);
            let done = done.map_err(|e| RpcError::failed(e.to_string()))?;
            done.result.map_err(|e| RpcError::failed(e.to_string()))?;
            tick = done.tick;
        }
        Ok(StrokeReply { samples: points.len() as u64 + 1, tick })
    }

    /// Waits until the loop has taken what was handed over before. Returns the tick.
    fn await_tick(&self, link: LoopLink<'_>) -> Result<u64, RpcError> {
        let quiet = crossbeam_channel::never::<()>();
        let give_up = self.clock.now_us() + PATIENCE.as_micros() as u64;
        let cut_off = self.clock.now_us() + CUT_OFF.as_micros() as u64;
        // The tick under way may have looked already.
        let by = link.published.load().tick + 2;
        loop {
            let shown = link.published.load();
            // Dabs that wait for their budget belong to the stroke.
            if shown.tick >= by && !shown.is_behind {
                link.commands.had_effect(shown.tick);
                return Ok(shown.tick);
            }
            let now_us = self.clock.now_us();
            if link.stopped() {
                return Err(not_taken());
            }
            if now_us > give_up {
                let text = "not finished after a minute: the stroke waits, and is made as soon as \
                            the loop comes to it";
                return Err(RpcError::failed(text));
            }
            if shown.standing.state == SharedState::CutOff && now_us > cut_off {
                let text = "cut off from the others: the stroke waits, and is made as soon as the \
                            host or a successor is heard; `people` says what waits";
                return Err(RpcError::failed(text));
            }
            let _ = quiet.recv_timeout(LOOK);
        }
    }

    fn push(&mut self, pen: Pen) {
        let t_us = self.clock.now_us();
        let body = Body::Pen(pen);
        self.sender.push(Sample { device: CONTROL_PEN_ID, t_us, device_t_us: None, body });
    }
}

fn not_taken() -> RpcError {
    RpcError::failed("the loop did not take the stroke")
}

/// A point of the stroke as the pen has it.
#[derive(Debug, Clone, Copy, PartialEq)]
struct ViewPoint {
    view: Vec2,
    pressure: f32,
    t_us: u64,
}

/// Every point in view coordinates.
fn in_view(shown: &Published, stroke: &StrokeParams) -> Result<Vec<ViewPoint>, RpcError> {
    let points = stroke.points.iter().enumerate();
    points
        .map(|(i, point)| {
            let (view, pressure, ms) = match *point {
                StrokePoint::View([x, y, pressure, ms]) => {
                    (Vec2::new(x as f32, y as f32), pressure, ms)
                }
                StrokePoint::World([x, y, z, pressure, ms]) => {
                    let at = Vec3::new(x as f32, y as f32, z as f32);
                    let view = seen(shown, at).ok_or_else(|| {
                        let text = "not seen from the camera as it stands";
                        RpcError::failed(format!("points[{i}]: {text}"))
                    })?;
                    (view, pressure, ms)
                }
            };
            Ok(ViewPoint { view, pressure: pressure as f32, t_us: (ms * 1e3) as u64 })
        })
        .collect()
}

/// Returns the view position of a point in world space; `None` if it is outside the view, behind
/// the camera, or hidden by the surface.
fn seen(shown: &Published, at: Vec3) -> Option<Vec2> {
    let view = shown.camera.project(at)?;
    if !(view.cmpge(Vec2::ZERO).all() && view.cmple(Vec2::ONE).all()) {
        return None;
    }
    let hit = shown.pick(shown.camera.ray(view))?;
    (hit.position.distance(at) <= shown.brush_radius * SEEN_WITHIN).then_some(view)
}
