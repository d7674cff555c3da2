//! The provisional dab: what a pen will raise until the frame is seen, shown before it has done so.
//!
//! Laws kept here:
//! * It is drawn and nothing else: the shader moves the vertices of the picture, so the clay
//!   depends on real samples alone, and the next snapshot takes the place of what was led.
//! * It is shown only where it is known what the brush will do: draw and inflate, whose dabs add
//!   up by their falloff, drawn evenly along the path. With any other only the ring runs ahead.

use bytemuck::{Pod, Zeroable};
use glam::{Vec2, Vec3};

use super::mirrors::mirrors;
use sculptd_clay::Ray;
use sculptd_clay::brush::{BrushKind, BrushSettings, Measure, Method, StampBy};
use sculptd_daemon::Published;
use sculptd_devices::DeviceId;
use sculptd_engine::camera::Camera;
use sculptd_engine::scene::ObjectTransform;
use sculptd_engine::stroke::PenPoint;

/// A dab and its mirror images at most.
pub const MAX_LED: usize = 8;
/// Values of the falloff from the middle to the rim, evenly spaced.
pub(super) const PROFILE: usize = 12;
/// The way for which a brush lays down its strength times its radius, in radii.
const FIFTH: f32 = 0.2;
/// Ways shorter than this share of the radius are not worth a frame.
const LEAST: f32 = 0.02;

/// The part of a stroke that is led: from where the pen was to where it will be.
#[derive(Debug, Clone, Copy, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct LedDab {
    from: [f32; 3],
    radius: f32,
    to: [f32; 3],
    unused: f32,
    /// Displacement in its middle: along the normal, in mesh units.
    by: [f32; 3],
    /// -1 where that leads into the clay, else 1.
    sign: f32,
}

impl LedDab {
    /// The same in the frame of an object, `own` being the inverse of its transform.
    fn seen_from(&self, own: &ObjectTransform) -> LedDab {
        let scale = own.scale as f32;
        LedDab {
            from: own.point(self.from.into()).to_array(),
            to: own.point(self.to.into()).to_array(),
            by: (own.direction(self.by.into()) * scale).to_array(),
            radius: self.radius * scale,
            ..*self
        }
    }
}

/// All that is led, as the shader has it.
#[derive(Debug, Clone, Copy, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct ProvisionalDabs {
    dabs: [LedDab; MAX_LED],
    profile: [f32; PROFILE],
    count: u32,
    unused: [u32; 3],
}

impl ProvisionalDabs {
    /// Leads the stroke of a pen, which is at `pen`, by as much as the pen has before it to `ahead`
    /// (both in view coordinates). Nothing before the stroke's first dab, where one of these places
    /// is not over the clay, and where it is not known what the brush will do.
    pub fn lead(
        state: &Published,
        camera: &Camera,
        (device, pen): (DeviceId, &PenPoint),
        ahead: Vec2,
    ) -> Self {
        let mut all = ProvisionalDabs::default();
        let brush = &state.brush;
        let Some((_, [last, normal])) = state.last_dabs.iter().flatten().find(|d| d.0 == device)
        else {
            return all;
        };
        if !is_known(brush) {
            return all;
        }
        for (x, value) in all.profile.iter_mut().enumerate() {
            let x = x as f32 / (PROFILE - 1) as f32;
            let x = ((x - brush.hardness) / (1.0 - brush.hardness)).max(0.0);
            *value = brush.falloff.at(x, &brush.curve);
        }
        let radius = state.brush_radius * brush.pressure_radius.factor(pen.pressure);
        let strength = brush.strength * brush.pressure_strength.factor(pen.pressure);
        let sign = if brush.negative != pen.inverted { -1.0 } else { 1.0 };
        let mut add = |from: Ray, to: Ray, last: Vec3, normal: Vec3| {
            let (Some(a), Some(b)) = (state.pick(from), state.pick(to)) else { return };
            // Along the surface that the stroke found: its later relief would distort the path.
            let way = b.position - a.position;
            let way = way - normal * way.dot(normal);
            let length = way.length();
            // A leap, as over an edge, is no stroke.
            if !(length > LEAST * radius && length < 2.0 * radius) {
                return;
            }
            let height = sign * strength * radius * (length / (FIFTH * radius));
            all.dabs[all.count as usize] = LedDab {
                from: last.to_array(),
                to: (last + way).to_array(),
                by: (normal * height).to_array(),
                radius,
                sign,
                ..LedDab::default()
            };
            all.count += 1;
        };
        let (from, to) = (camera.ray(pen.view), camera.ray(ahead));
        add(from, to, *last, *normal);
        // Mirrors are in the object's frame.
        let to_world = state.transform();
        let own = to_world.inverse();
        let middle = own.point(state.middle);
        for m in mirrors(brush.symmetry) {
            let place = |p: Vec3| to_world.point(middle + (own.point(p) - middle) * m);
            let direction = |d: Vec3| to_world.direction(own.direction(d) * m);
            let mirrored = |r: Ray| Ray { origin: place(r.origin), dir: direction(r.dir) };
            add(mirrored(from), mirrored(to), place(*last), direction(*normal));
        }
        all
    }

    /// Returns true if there are no provisional dabs.
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// The same in the frame of an object.
    pub(super) fn seen_from(&self, transform: &ObjectTransform) -> ProvisionalDabs {
        let own = transform.inverse();
        ProvisionalDabs { dabs: self.dabs.map(|d| d.seen_from(&own)), ..*self }
    }
}

/// Returns true if dabs of this brush add up along the path by their falloff alone.
fn is_known(brush: &BrushSettings) -> bool {
    use BrushKind::{Draw, Inflate};
    let path = &brush.path;
    // The next dab's normal is unknown if it is measured on the relief raised so far.
    matches!(brush.kind, Draw | Inflate)
        && !brush.accumulate
        && brush.topology.by == Measure::Off
        && path.method == Method::Space
        && path.compensate
        && path.rope == 0.0
        && path.average <= 1
        && path.jitter == 0.0
        && brush.stamp.by == StampBy::Off
        && brush.saturation == 0.0
        && !brush.auto.is_on()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_brushes_that_add_up_are_led() {
        let draw = BrushSettings { accumulate: false, ..BrushSettings::new(BrushKind::Draw) };
        assert!(is_known(&draw));
        assert!(!is_known(&BrushSettings::new(BrushKind::Smooth)));
        assert!(!is_known(&BrushSettings { accumulate: true, ..draw }));
        assert!(!is_known(&BrushSettings { saturation: 1.0, ..draw }));
        let mut roped = draw;
        roped.path.rope = 0.1;
        assert!(!is_known(&roped));
    }

    #[test]
    fn what_is_led_is_carried_into_an_object_s_frame() {
        let dab = LedDab {
            from: [2.0, 0.0, 0.0],
            to: [4.0, 0.0, 0.0],
            by: [0.0, 0.0, 0.5],
            radius: 1.0,
            ..LedDab::default()
        };
        let all = ProvisionalDabs { dabs: [dab; MAX_LED], count: 1, ..Default::default() };
        let twice = ObjectTransform { scale: 2.0, ..ObjectTransform::default() };
        let own = all.seen_from(&twice).dabs[0];
        assert_eq!((own.from, own.to), ([1.0, 0.0, 0.0], [2.0, 0.0, 0.0]));
        assert_eq!((own.by, own.radius), ([0.0, 0.0, 0.25], 0.5));
    }
}
