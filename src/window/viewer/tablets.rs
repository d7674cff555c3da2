//! One pen, one stroke: a desktop moves its pointer with the pen that the daemon reads as well.
//!
//! Laws kept here:
//! * A pointer that follows a tablet's pen is not a second pen: the tablet's samples sculpt, at the
//!   place of the desktop's pointer, and with their pressure and tilt.
//! * Over a panel, behind another window, and until the map is known, the pen is only a pointer.
//!   Until the map is known, the pointer has the pen's pressure and tilt.
//! * Keyboard focus does not determine where the pen is.
//! * A mouse used at the same time is a separate pen.
//! * A click that the desktop makes of a pad's key does nothing over the view: the key has its
//!   bound action.

use std::sync::Arc;

use glam::{DVec2, Vec2};

use super::input::takes_presses;
use super::pointer::{Drag, give_back, lent};
use super::provisional::ProvisionalDabs;
use super::state::WindowState;
use super::tablet_map::{LATE_US, TabletMap, Tablets};
use super::wiring::Wiring;
use crate::panels::views;
use sculptd_daemon::Published;
use sculptd_daemon::adaptors::TABLET_IDS;
use sculptd_devices::DeviceId;
use sculptd_engine::command::Command;
use sculptd_engine::desktop_layout::{DesktopLayout, MAX_COVERS, MAX_TABLETS, PenPlace};
use sculptd_engine::stroke::PenPoint;

/// A map is sent again when it has moved by this share of the view: a third of a pixel.
const MOVED: f32 = 2e-4;

impl WindowState {
    /// A pixel of this window as one of the whole desktop.
    fn on_screen(&self, at: Vec2) -> DVec2 {
        // Wayland tells no window where it is: the map is then one to the window itself.
        let corner = self.window.inner_position().unwrap_or_default();
        at.as_dvec2() + DVec2::new(f64::from(corner.x), f64::from(corner.y))
    }

    /// Returns the time at which a frame drawn now will be seen, from the median times of drawing
    /// and presenting.
    fn seen_us(&self, wiring: &Wiring) -> u64 {
        let latency = wiring.link.present_latency();
        let [_, _, draw, present, _] = latency.stages();
        wiring.clock.now_us() + draw.quantiles().p50 + present.quantiles().p50
    }

    /// Returns the predicted view position of a tablet's pen when a frame drawn now is seen; `None`
    /// for another device. Only drawing uses it: sculpting depends on the pen's samples alone.
    pub(super) fn predicted(&self, device: DeviceId, wiring: &Wiring) -> Option<Vec2> {
        let (_, map) = self.tablets.known.iter().find(|t| t.0 == device)?;
        let share = map.predictor().place_at(self.seen_us(wiring))?;
        Some(self.tablets.sent.place(device).unwrap_or_default().view(share.as_vec2()))
    }

    /// Returns the dabs that a tablet's pen will have made when a frame drawn now is seen.
    pub(super) fn led(&self, state: &Published, wiring: &Wiring) -> ProvisionalDabs {
        let drawing = |id: DeviceId| state.last_dabs.iter().flatten().any(|d| d.0 == id);
        let pen = state.pens.iter().flatten().find(|(id, _)| drawing(*id));
        pen.filter(|_| self.ui_state.prefs.lead_strokes)
            .and_then(|(id, pen)| Some((id, pen, self.predicted(*id, wiring)?)))
            .map(|(id, pen, ahead)| ProvisionalDabs::lead(state, &self.camera, (*id, pen), ahead))
            .unwrap_or_default()
    }

    /// Returns true if a ring is shown ahead of its pen: the next frame shows it elsewhere, even if
    /// nothing else has changed.
    pub(super) fn leads_a_pen(&self, wiring: &Wiring) -> bool {
        let now = wiring.clock.now_us();
        let mut all = self.tablets.known.iter().map(|t| t.1.predictor().ahead(now));
        all.any(|ahead| ahead.length() > f64::from(MOVED))
    }

    /// Returns true if the pointer, at its current position, follows the pen of a tablet.
    pub(super) fn pointer_is_a_pen(&self, wiring: &Wiring) -> bool {
        let (now, at) = (wiring.clock.now_us(), self.on_screen(self.pointer.at));
        let since = self.tablets.taken_us;
        self.tablets.known.iter().any(|(_, map)| map.owns(now, since, at))
    }

    /// The same of a press: whether the pen's own samples sculpt what this press would.
    pub(super) fn press_is_a_pens(&mut self, wiring: &Wiring) -> bool {
        let (now, at) = (wiring.clock.now_us(), self.on_screen(self.pointer.at));
        let since = self.tablets.taken_us;
        let mut all = self.tablets.known.iter_mut().map(|t| &mut t.1);
        all.any(|map| map.takes_press(now, since, at))
    }

    /// Returns true if a press is the click that an X server makes of a pad's key. The key was
    /// pressed since the window last took every event, or shortly before. A key makes one click.
    pub(super) fn press_is_a_keys(&mut self) -> bool {
        let key_us = self.tablets.key_us.take();
        key_us.is_some_and(|key_us| key_us + LATE_US >= self.tablets.taken_us)
    }

    /// The pen whose pointer sculpts in its place, because the desktop's map is not known yet: its
    /// pressure and its tilt are the pointer's.
    pub(super) fn pen_at_pointer(&self, wiring: &Wiring) -> Option<PenPoint> {
        let undecided = |id: DeviceId| {
            self.tablets.known.iter().any(|(known, map)| *known == id && map.is_undecided())
        };
        let state = wiring.published.load();
        state.pens.iter().flatten().find(|(id, _)| undecided(*id)).map(|(_, pen)| *pen)
    }

    /// Takes where the pens were since the last call.
    pub(super) fn take_trail(&mut self, wiring: &Wiring) {
        let tablets = &mut self.tablets;
        for place in wiring.pen_trail.take() {
            if place.key {
                tablets.key_us = Some(place.t_us);
                continue;
            }
            let at = tablets.known.iter().position(|t| t.0 == place.device);
            if at.is_none() && (place.share.is_none() || tablets.known.len() >= MAX_TABLETS) {
                continue;
            }
            let at = at.unwrap_or_else(|| {
                tablets.known.push((place.device, TabletMap::default()));
                tablets.known.len() - 1
            });
            let share = place.share.map(|s| s.as_dvec2());
            tablets.known[at].1.pen(place.t_us, share, place.tip);
        }
    }

    /// Every event that waited was taken.
    pub(super) fn events_taken(&mut self, wiring: &Wiring) {
        self.tablets.taken_us = wiring.clock.now_us();
    }

    /// Returns true if the pointer has moved since it was last paired with the pens of tablets.
    pub(super) fn pointer_is_unpaired(&self) -> bool {
        self.pointer.inside && self.tablets.paired != Some(self.pointer.at)
    }

    /// Looks at where pens and pointer are, learns, and tells the daemon what has changed.
    pub(super) fn follow_tablets(&mut self, state: &Arc<Published>, wiring: &Wiring) {
        let now = wiring.clock.now_us();
        self.tablets.in_range.clear();
        let shown = state.tablets.iter().flatten().map(|t| t.0);
        self.tablets.in_range.extend(shown.filter(|id| TABLET_IDS.contains(&id.0)));
        self.take_trail(wiring);
        if self.pointer_is_unpaired() {
            let moved = self.tablets.paired.replace(self.pointer.at).is_some();
            let at = self.on_screen(self.pointer.at);
            let Tablets { known, in_range, .. } = &mut self.tablets;
            for (_, map) in known.iter_mut().filter(|t| moved && in_range.contains(&t.0)) {
                map.pointer(now, at);
            }
        }
        self.follow_pens(state, wiring);
        let (corner, size) = self.view_rect();
        wiring.link.set_view_on_desktop(self.on_screen(corner), size.as_dvec2());
        let desktop = self.desktop(wiring);
        if differs(&desktop, &self.tablets.sent) {
            if desktop.tablets != self.tablets.sent.tablets {
                tracing::debug!("the tablets on the desktop: {:?}", self.tablet_lines());
            }
            self.tablets.sent = desktop;
            wiring.link.claim_desktop(desktop);
            let _ = wiring.commands.try_send(Command::DesktopLayout(desktop));
        }
    }

    fn desktop(&self, wiring: &Wiring) -> DesktopLayout {
        let mut desktop = DesktopLayout::default();
        let (corner, size) = self.view_rect();
        let zero = self.on_screen(corner);
        // A pen that moves no pointer covers all views.
        let (first, all) = self.clay_rect();
        let spread = PenPlace::Mapped {
            origin: (first - corner) / size,
            across: Vec2::new(all.x / size.x, 0.0),
            down: Vec2::new(0.0, all.y / size.y),
        };
        let view = |v: DVec2| v.as_vec2() / size;
        for (slot, (id, map)) in desktop.tablets.iter_mut().zip(&self.tablets.known) {
            let place = match map.map() {
                Some(map) => PenPlace::Mapped {
                    origin: view(map.origin - zero),
                    across: view(map.across),
                    down: view(map.down),
                },
                None if map.is_undecided() => PenPlace::Unknown,
                None => continue,
            };
            *slot = Some((*id, place));
        }
        // A form that is cut is only looked at.
        if self.ui_state.look.cut.is_some() {
            let all = self.tablets.in_range.iter().map(|id| Some((*id, PenPlace::Off)));
            let places = all.chain(std::iter::repeat(None));
            desktop.tablets.iter_mut().zip(places).for_each(|(slot, place)| *slot = place);
            return desktop;
        }
        // An installation has the whole screen, and nothing covers it.
        let follows = desktop.tablets.iter().any(Option::is_some);
        if self.views.are_four() {
            let others =
                self.tablets.in_range.iter().filter(|id| !self.tablets.moves_pointer(**id));
            let slots = desktop.tablets.iter_mut().filter(|slot| slot.is_none());
            for (slot, id) in slots.zip(others) {
                *slot = Some((*id, spread));
            }
        }
        if wiring.kiosk.is_none() && follows {
            // A window without the keyboard is drawn on as any other: the desktop says whether the
            // pointer is in it, and would not where another window lay before it.
            desktop.away = !self.pointer.inside;
            for (slot, cover) in desktop.covers.iter_mut().zip(self.covers()) {
                *slot = Some(cover.map(|at| (at - corner) / size));
            }
        }
        desktop
    }

    /// Returns the areas over the view that take presses: least and greatest corner, in pixels.
    fn covers(&self) -> Vec<[Vec2; 2]> {
        let context = self.egui.egui_ctx();
        let scale = context.pixels_per_point();
        let mut layers: Vec<egui::LayerId> =
            context.memory(|m| m.areas().visible_layer_ids()).into_iter().collect();
        // If there are too many, names of views are left out.
        layers.sort_unstable_by_key(|l| (views::is_name(l.id), l.order, l.id.value()));
        let above =
            |rect: &egui::Rect| context.layer_id_at(rect.center()).is_some_and(takes_presses);
        layers
            .into_iter()
            .filter(|l| takes_presses(*l))
            .filter_map(|l| context.memory(|m| m.area_rect(l.id)))
            .filter(above)
            .map(|r| [Vec2::new(r.min.x, r.min.y) * scale, Vec2::new(r.max.x, r.max.y) * scale])
            .take(MAX_COVERS)
            .collect()
    }

    /// Shift and Ctrl change the brush of a pen before it touches: its first sample comes to the
    /// daemon sooner than the window hears of the press.
    pub(super) fn lend_to_pens(&mut self, wiring: &Wiring) {
        let busy = self.ui_state.modal.is_some() || self.ui_state.radial.is_some();
        // A pen that has left in the meantime gives back what it was lent.
        let nobody = self.tablets.in_range.is_empty() && self.pointer.lent.is_none();
        if busy || self.pointer.drag != Drag::None || nobody {
            return;
        }
        let state = wiring.published.load();
        let brush = self.pointer.lent.unwrap_or(state.brush);
        let now = lent(brush, self.mods, &wiring.presets, &state.kept_brushes);
        let before = self.pointer.lent;
        self.pointer.lent = (now != brush).then_some(brush);
        if self.pointer.lent != before {
            wiring.link.claim_lent(self.pointer.lent);
        }
        if before.is_some() && self.pointer.lent.is_none() {
            for brush in give_back(state.brush.key(), now, &wiring.presets, &state.kept_brushes) {
                let _ = wiring.commands.try_send(Command::Brush(brush));
            }
        } else if self.pointer.lent != before {
            let _ = wiring.commands.try_send(Command::Brush(now));
        }
    }

    /// One line for each tablet that the pointer follows.
    pub(super) fn tablet_lines(&self) -> Vec<String> {
        let line = |(id, map): &(DeviceId, TabletMap)| {
            let found = map.map()?;
            let (delay_us, off) = map.fit();
            let (w, h) = (found.across.length(), found.down.length());
            let turn = found.across.y.atan2(found.across.x).to_degrees();
            Some(format!(
                "tablet {}: its area covers {w:.0} x {h:.0} pixels of the desktop from {:.0}, \
                 {:.0}, turned by {turn:.0} degrees (found by itself, {off:.1} pixels off, the \
                 pointer {} ms later)",
                id.0,
                found.origin.x,
                found.origin.y,
                delay_us / 1000
            ))
        };
        self.tablets.known.iter().filter_map(line).collect()
    }
}

/// Returns true if the daemon must receive the new layout.
fn differs(a: &DesktopLayout, b: &DesktopLayout) -> bool {
    let pairs = a.tablets.iter().zip(&b.tablets);
    a.away != b.away || a.covers != b.covers || !pairs.into_iter().all(|(a, b)| alike(a, b))
}

/// Returns true if two mappings of a tablet look the same.
fn alike(a: &Option<(DeviceId, PenPlace)>, b: &Option<(DeviceId, PenPlace)>) -> bool {
    let near = |a: Vec2, b: Vec2| (a - b).abs().max_element() <= MOVED;
    let (Some((i, place)), Some((j, other))) = (a, b) else { return a == b };
    match (*place, *other) {
        (
            PenPlace::Mapped { origin, across, down },
            PenPlace::Mapped { origin: o, across: x, down: y },
        ) => i == j && near(origin, o) && near(across, x) && near(down, y),
        _ => a == b,
    }
}
