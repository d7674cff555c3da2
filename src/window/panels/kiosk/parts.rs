//! Parts of the screen: buttons for fingertips and for one switch, and places for them.

use egui::{Align2, Area, Button, Id, RichText, vec2};

use crate::panels::state::KioskPad;
use crate::panels::theme;
use sculptd_daemon::kiosk::desk::Screen;

/// Smallest side of anything that is pressed, points: a fingertip on a 24-inch screen covers about
/// half of it.
pub const TARGET: f32 = 64.0;

/// The buttons of one frame, each lit in turn for people who press one switch.
pub(super) struct Scan {
    /// Index of the highlighted button among those of the last frame; `None`: none is highlighted.
    lit: Option<usize>,
    /// The switch was pressed in this frame.
    pub(super) pressed: bool,
    pub(super) count: usize,
}

impl Scan {
    pub(super) fn begin(ctx: &egui::Context, screen: &Screen, pad: &KioskPad) -> Scan {
        let each = screen.show.scan_s;
        if each <= 0.0 || pad.targets == 0 {
            return Scan { lit: None, pressed: false, count: 0 };
        }
        let (turns, pressed) = ctx.input(|i| {
            let down = |e: &egui::Event| {
                matches!(e, egui::Event::Key { pressed: true, repeat: false, .. })
            };
            (i.time / each, i.events.iter().any(down))
        });
        let next = (1.0 - turns.fract()) * each;
        ctx.request_repaint_after(std::time::Duration::from_secs_f64(next.max(0.01)));
        Scan { lit: Some(turns as usize % pad.targets), pressed, count: 0 }
    }

    /// Adds a button; whether it was pressed, by the switch too while it is lit.
    pub(super) fn button(&mut self, ui: &mut egui::Ui, enabled: bool, button: Button<'_>) -> bool {
        let response = ui.add_enabled(enabled, button);
        if !enabled {
            return false;
        }
        let lit = self.lit == Some(self.count);
        self.count += 1;
        if lit {
            let stroke = egui::Stroke::new(5.0, theme::accent(ui));
            let around = response.rect.expand(3.0);
            ui.painter().rect_stroke(around, 12, stroke, egui::StrokeKind::Outside);
        }
        response.clicked() || lit && self.pressed
    }
}

/// Returns a button for a fingertip, at least `width` points wide.
pub(super) fn large(text: &str, size: f32, width: f32) -> Button<'static> {
    Button::new(RichText::new(text.to_owned()).size(size))
        .min_size(vec2(width, TARGET + 8.0))
        .corner_radius(10)
}

/// Puts something at an edge or in the middle of the screen.
pub(super) fn place(
    ctx: &egui::Context,
    name: &str,
    free: egui::Rect,
    align: Align2,
    what: impl FnOnce(&mut egui::Ui),
) {
    let inner = free.shrink(24.0);
    let at = align.pos_in_rect(&inner);
    let area = Area::new(Id::unique(name)).fixed_pos(at).pivot(align).constrain_to(free);
    area.show(ctx, |ui| {
        egui::Frame::popup(ui.style()).inner_margin(14.0).corner_radius(14).show(ui, what);
    });
}

/// Returns the size of a text in one line.
pub(super) fn text_size(ui: &egui::Ui, text: &str, size: f32) -> egui::Vec2 {
    let font = egui::FontId::proportional(size);
    ui.painter().layout_no_wrap(text.into(), font, egui::Color32::PLACEHOLDER).size()
}
