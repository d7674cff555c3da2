//! The window's own pointer: where it is, what a pressed button drags, and its pressure.

use glam::Vec2;
use winit::keyboard::ModifiersState;

use super::gizmo::GizmoDrag;
use sculptd_clay::brush::{BrushKind, BrushSettings, Presets};

/// Action of a pressed button.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Drag {
    #[default]
    None,
    Sculpt,
    Orbit,
    Pan,
    /// A handle of the gizmo.
    Gizmo,
}

#[derive(Debug, Default)]
pub struct Pointer {
    /// Pixels from the top left.
    pub at: Vec2,
    pub inside: bool,
    pub drag: Drag,
    /// Force of the press, if the window system reports it.
    pub force: Option<f32>,
    /// Time of the current event, in microseconds; `None`: now.
    pub(super) t_us: Option<u64>,
    /// Settings of the brush before Shift or Ctrl changed it for one stroke.
    pub(super) lent: Option<BrushSettings>,
    pub(super) speed: Speed,
    /// Time and position of the last press beside the clay, in microseconds and pixels.
    pub(super) beside: Option<(u64, Vec2)>,
    /// The handle of the gizmo that is dragged.
    pub(super) gizmo: Option<GizmoDrag>,
}

/// The speed of a pointer as a stand-in for its pressure: slow strokes press harder than quick
/// ones, as hands do.
#[derive(Debug, Default)]
pub struct Speed {
    last: Option<(u64, Vec2)>,
    /// Views a second, smoothed.
    speed: f32,
}

/// Pressure of a pointer at rest, and how much of it is lost to speed.
const RESTING: f32 = 0.8;
const LOST: f32 = 0.45;
/// Views a second at which half of that is lost.
const BRISK: f32 = 1.2;
/// Seconds over which the speed is smoothed.
const SMOOTH_S: f32 = 0.05;
/// Of a pointer whose speed does not count: two thirds, so that a pen can press harder and softer
/// than it.
pub(super) const PLAIN: f32 = 0.66;

impl Speed {
    /// Takes a place in views at a time in microseconds; the pressure, 0 to 1.
    pub fn pressure(&mut self, t_us: u64, at: Vec2) -> f32 {
        if let Some((last_us, last)) = self.last {
            let dt = (t_us.saturating_sub(last_us) as f32 * 1e-6).max(1e-4);
            let now = (at - last).length() / dt;
            self.speed += (now - self.speed) * (1.0 - (-dt / SMOOTH_S).exp());
        }
        self.last = Some((t_us, at));
        RESTING - LOST * self.speed / (self.speed + BRISK)
    }
}

/// The brush for one stroke with these keys down: Shift evens, Ctrl and Alt turn it round.
/// Slide-relax evens by itself.
pub(super) fn lent(
    brush: BrushSettings,
    mods: ModifiersState,
    presets: &Presets,
    kept: &[BrushSettings],
) -> BrushSettings {
    let mut now = match (mods.shift_key(), brush.kind) {
        (true, BrushKind::SlideRelax) => BrushSettings { negative: !brush.negative, ..brush },
        // At the size in hand: it evens what the other brush made.
        (true, _) => BrushSettings {
            radius: brush.radius,
            ..presets.recalled(&brush, kept, BrushKind::Smooth)
        },
        (false, _) => brush,
    };
    now.negative ^= mods.control_key() || mods.alt_key();
    now
}

/// Returns the brushes to send to the world, in this order, when `brush` comes back after a
/// temporary brush with the key `lent`. The temporary one comes first, as it was before the keys
/// inverted it, because the world stores the settings of the brush that it replaces.
pub(super) fn give_back(
    lent: (BrushKind, u32),
    brush: BrushSettings,
    presets: &Presets,
    kept: &[BrushSettings],
) -> impl Iterator<Item = BrushSettings> {
    let before = (lent != brush.key()).then(|| presets.kept(&brush, kept, lent));
    before.into_iter().chain([brush])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shift_evens_and_slide_relax_relaxes() {
        let presets = Presets::default();
        let of = |kind| presets.of(kind);
        let lent = |brush, mods| lent(brush, mods, &presets, &[]);
        assert_eq!(lent(of(BrushKind::Draw), ModifiersState::SHIFT).kind, BrushKind::Smooth);
        let relaxing = lent(of(BrushKind::SlideRelax), ModifiersState::SHIFT);
        assert!(relaxing.kind == BrushKind::SlideRelax && relaxing.negative);
        assert!(lent(of(BrushKind::Draw), ModifiersState::CONTROL).negative);
        assert_eq!(lent(of(BrushKind::Draw), ModifiersState::empty()), of(BrushKind::Draw));
    }

    #[test]
    fn a_lent_brush_is_put_away_as_it_was() {
        let presets = Presets::default();
        let draw = presets.of(BrushKind::Draw);
        let smooth = presets.of(BrushKind::Smooth);
        let kept = [BrushSettings { strength: 0.7, radius: 0.4, ..smooth }];
        let mods = ModifiersState::SHIFT | ModifiersState::CONTROL;
        let smooth = lent(draw, mods, &presets, &kept);
        assert!(smooth.kind == BrushKind::Smooth && smooth.negative);
        assert_eq!(smooth.radius, draw.radius, "it evens at the size in hand");
        let told: Vec<BrushSettings> = give_back(smooth.key(), draw, &presets, &kept).collect();
        assert_eq!(told, [kept[0], draw]);
        assert_eq!(give_back(draw.key(), draw, &presets, &kept).count(), 1);
    }

    #[test]
    fn a_slow_pointer_presses_harder_than_a_quick_one() {
        let run = |views_a_second: f32| {
            let mut speed = Speed::default();
            (0..60u64)
                .map(|i| {
                    speed.pressure(i * 8000, Vec2::new(i as f32 * 0.008 * views_a_second, 0.0))
                })
                .last()
                .unwrap_or(0.0)
        };
        let (still, slow, quick) = (run(0.0), run(0.2), run(3.0));
        assert!((still - RESTING).abs() < 1e-6);
        assert!(still > slow && slow > quick && quick > RESTING - LOST);
    }
}
