//! The clay from one side or from four at once: which views there are, where they lie, and in which
//! of them is worked.
//!
//! Laws kept here:
//! * The world has one camera, that of the view in which is worked; the others are the window's.
//! * The three views along an axis keep their direction: what would turn one turns the free view.

use glam::{Vec2, Vec3};

use sculptd_engine::camera::{Camera, MAX_PITCH};

/// Pixels between two views.
pub const SEAM: f32 = 2.0;

/// One of the four views. In one window they lie as in the drawings of engineers: the front below
/// the top, the right side beside the front.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum ViewKind {
    Top,
    /// The camera that turns as one likes.
    #[default]
    Free,
    Front,
    Right,
}

impl ViewKind {
    /// All of them, row by row.
    pub const ALL: [ViewKind; 4] =
        [ViewKind::Top, ViewKind::Free, ViewKind::Front, ViewKind::Right];

    /// The message of its name.
    pub fn title(self) -> &'static str {
        match self {
            ViewKind::Top => "view-top",
            ViewKind::Free => "view-free",
            ViewKind::Front => "view-front",
            ViewKind::Right => "view-right",
        }
    }

    /// Yaw and pitch of a view along an axis; `None`: it turns.
    pub fn direction(self) -> Option<(f32, f32)> {
        match self {
            ViewKind::Top => Some((0.0, MAX_PITCH)),
            ViewKind::Free => None,
            ViewKind::Front => Some((0.0, 0.0)),
            ViewKind::Right => Some((std::f32::consts::FRAC_PI_2, 0.0)),
        }
    }

    /// Returns true if a camera has this view's direction.
    fn is_of(self, camera: &Camera) -> bool {
        let turned = self.direction().is_some_and(|to| to != (camera.yaw, camera.pitch));
        self == ViewKind::Free || camera.orthographic && !turned
    }
}

/// The views of a window, and the cameras of those in which is not worked.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Views {
    split: bool,
    active: ViewKind,
    /// In the order of [`ViewKind::ALL`]. That of the active view is older than the window's own.
    cameras: [Camera; 4],
}

impl Views {
    /// Returns true if four views are shown.
    pub fn are_four(&self) -> bool {
        self.split
    }

    /// The view in which is worked.
    pub fn active(&self) -> ViewKind {
        self.active
    }

    /// The views that are shown.
    pub fn shown(&self) -> &'static [ViewKind] {
        match (self.split, self.active) {
            (true, _) => &ViewKind::ALL,
            (false, kind) => &ViewKind::ALL[kind as usize..=kind as usize],
        }
    }

    /// Returns true if the active view keeps its direction.
    pub fn is_held(&self) -> bool {
        self.split && self.active != ViewKind::Free
    }

    /// The camera of a view, while `now` is that of the active one.
    pub fn camera(&self, kind: ViewKind, now: &Camera) -> Camera {
        let camera = if kind == self.active { *now } else { self.cameras[kind as usize] };
        Camera { aspect: now.aspect, ..camera }
    }

    /// Shows four views, `now` being the camera of the one; those along an axis show the box from
    /// `lo` to `hi`, where there is one. Work goes on in the same view.
    pub fn show_four(&mut self, now: &Camera, lo: Vec3, hi: Vec3) {
        // A view that was turned meanwhile is the free one.
        if !self.active.is_of(now) {
            self.active = ViewKind::Free;
        }
        self.split = true;
        self.cameras[self.active as usize] = *now;
        for kind in ViewKind::ALL {
            let Some((yaw, pitch)) = kind.direction().filter(|_| kind != self.active) else {
                continue;
            };
            let mut camera = Camera { yaw, pitch, orthographic: true, ..*now };
            if lo.cmple(hi).all() {
                camera.frame(lo, hi);
            }
            self.cameras[kind as usize] = camera;
        }
    }

    /// Shows one view, and works in it; its camera, `now` being that of the active one.
    pub fn show_one(&mut self, kind: ViewKind, now: &Camera) -> Camera {
        let camera = self.work_in(kind, now);
        self.split = false;
        camera
    }

    /// Works in another view; its camera, `now` being that of the one that is left.
    pub fn work_in(&mut self, kind: ViewKind, now: &Camera) -> Camera {
        self.cameras[self.active as usize] = *now;
        self.active = kind;
        Camera { aspect: now.aspect, ..self.cameras[kind as usize] }
    }

    /// The camera after `asked` was asked for, which was made from `now`. Where that would turn a
    /// view along an axis, the free one is turned instead, and worked in.
    pub fn take(&mut self, asked: Camera, now: &Camera) -> Camera {
        if !self.split || self.active.is_of(&asked) {
            return asked;
        }
        let free = self.work_in(ViewKind::Free, now);
        if (asked.target, asked.distance) != (now.target, now.distance) {
            return Camera { aspect: now.aspect, ..asked };
        }
        // Only what was changed: the free view keeps its place.
        let turned = (asked.yaw, asked.pitch) != (now.yaw, now.pitch);
        let (yaw, pitch) = if turned { (asked.yaw, asked.pitch) } else { (free.yaw, free.pitch) };
        let parallel = asked.orthographic != now.orthographic;
        let orthographic = if parallel { asked.orthographic } else { free.orthographic };
        Camera { yaw, pitch, orthographic, fov_y: asked.fov_y, ..free }
    }

    /// The part of the clay's rectangle that a view takes: top left corner and size, in whole
    /// pixels where the rectangle is in them. All parts are of one size, at least one pixel.
    pub fn part(&self, kind: ViewKind, (corner, size): (Vec2, Vec2)) -> (Vec2, Vec2) {
        if !self.split {
            return (corner, size);
        }
        let half = ((size - SEAM) * 0.5).floor().max(Vec2::ONE);
        let cell = kind as usize;
        let far = Vec2::new((cell % 2) as f32, (cell / 2) as f32);
        (corner + (size - half).max(Vec2::ZERO) * far, half)
    }

    /// The view at a place; on a seam one of those beside it, beyond the clay the nearest.
    pub fn at(&self, place: Vec2, (corner, size): (Vec2, Vec2)) -> ViewKind {
        if !self.split {
            return self.active;
        }
        let middle = corner + size * 0.5;
        let (right, below) = (place.x >= middle.x, place.y >= middle.y);
        ViewKind::ALL[usize::from(right) + 2 * usize::from(below)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RECT: (Vec2, Vec2) = (Vec2::new(236.0, 10.0), Vec2::new(807.0, 701.0));

    fn four() -> (Views, Camera) {
        let (mut views, now) = (Views::default(), Camera { aspect: 1.2, ..Camera::default() });
        views.show_four(&now, Vec3::splat(-2.0), Vec3::splat(2.0));
        (views, now)
    }

    #[test]
    fn four_parts_of_one_size_fill_the_clay_but_for_the_seams() {
        let (views, _) = four();
        let all = ViewKind::ALL.map(|kind| views.part(kind, RECT));
        let (corner, size) = RECT;
        for (kind, (at, part)) in ViewKind::ALL.into_iter().zip(all) {
            assert_eq!(part, all[0].1);
            assert_eq!((at.fract(), part.fract()), (Vec2::ZERO, Vec2::ZERO), "whole pixels");
            assert!(at.cmpge(corner).all() && (at + part).cmple(corner + size).all());
            for share in [0.001, 0.5, 0.999] {
                assert_eq!(views.at(at + part * share, RECT), kind);
            }
        }
        let seam = all[1].0.x - (all[0].0.x + all[0].1.x);
        assert!((SEAM..SEAM + 2.0).contains(&seam), "{seam}");
        assert_eq!(all[3].0 + all[3].1, corner + size);
        let one = Views::default();
        assert_eq!(one.part(ViewKind::Free, RECT), RECT);
        assert_eq!(one.at(Vec2::splat(-5.0), RECT), ViewKind::Free);
        // However small the window is.
        let tiny = (Vec2::ZERO, Vec2::ONE);
        assert_eq!(views.part(ViewKind::Right, tiny), tiny);
    }

    #[test]
    fn views_along_an_axis_are_parallel_and_show_all() {
        let (views, now) = four();
        for kind in ViewKind::ALL {
            let camera = views.camera(kind, &now);
            assert!(camera.is_sane());
            let Some(direction) = kind.direction() else {
                assert_eq!(camera, now);
                continue;
            };
            assert_eq!((camera.yaw, camera.pitch), direction);
            assert!(camera.orthographic);
            for corner in [Vec3::splat(-2.0), Vec3::splat(2.0)] {
                let seen = camera.project(corner).expect("before the eye");
                assert!(seen.cmpge(Vec2::ZERO).all() && seen.cmple(Vec2::ONE).all(), "{seen}");
            }
        }
    }

    #[test]
    fn each_view_is_left_as_it_was() {
        let (mut views, free) = four();
        let mut front = views.work_in(ViewKind::Front, &free);
        assert!(views.is_held() && views.active() == ViewKind::Front);
        front.zoom(2.0);
        let back = views.work_in(ViewKind::Free, &front);
        assert_eq!(back, free);
        assert_eq!(views.camera(ViewKind::Front, &free), front);
        // One view, and the four again: the free camera is the same, and work goes on in front.
        let one = views.show_one(ViewKind::Front, &free);
        assert!(one == front && !views.are_four() && !views.is_held());
        assert_eq!(views.shown(), [ViewKind::Front]);
        views.show_four(&one, Vec3::splat(-2.0), Vec3::splat(2.0));
        assert_eq!(views.active(), ViewKind::Front);
        assert_eq!(views.camera(ViewKind::Free, &one), free);
        assert_eq!(views.camera(ViewKind::Front, &one), front, "as it was zoomed");
        // A front view that was turned while it was alone is the free one from then on.
        let mut turned = views.show_one(ViewKind::Front, &one);
        turned.orbit(Vec2::new(0.1, 0.1));
        views.show_four(&turned, Vec3::splat(-2.0), Vec3::splat(2.0));
        assert_eq!(views.camera(ViewKind::Free, &turned), turned);
        assert_eq!(views.active(), ViewKind::Free);
    }

    #[test]
    fn what_would_turn_a_view_along_an_axis_turns_the_free_one() {
        let (mut views, free) = four();
        let front = views.work_in(ViewKind::Front, &free);
        let nearer = Camera { distance: front.distance * 0.5, ..front };
        assert_eq!(views.take(nearer, &front), nearer);
        assert_eq!(views.active(), ViewKind::Front, "coming nearer turns nothing");
        let behind = Camera { yaw: 3.0, ..nearer };
        let taken = views.take(behind, &nearer);
        assert_eq!(taken, Camera { yaw: 3.0, pitch: 0.0, ..free });
        assert_eq!(views.active(), ViewKind::Free);
        assert_eq!(views.camera(ViewKind::Front, &taken), nearer);
        // A camera with another target is a saved one, and is taken whole.
        let front = views.work_in(ViewKind::Front, &taken);
        let kept = Camera { target: Vec3::ONE, pitch: 0.4, ..Camera::default() };
        assert_eq!(views.take(kept, &front), Camera { aspect: front.aspect, ..kept });
        // The free view changes to perspective too.
        let front = views.work_in(ViewKind::Front, &taken);
        let deep = Camera { orthographic: false, ..front };
        assert_eq!(views.take(deep, &front), Camera { orthographic: false, ..taken });
        // One view is turned as it likes.
        let mut one = Views::default();
        assert_eq!(one.take(kept, &free), kept);
    }
}
