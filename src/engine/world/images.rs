//! The images of a brush: its mirrors and turns.

use glam::{Mat3, Vec3};

use sculptd_clay::brush::BrushSettings;
use sculptd_clay::brush::options::IMAGES;
use sculptd_geometry::portable::turn_matrix;

/// A map from the brush to one of its images: `m * p + t`.
#[derive(Debug, Clone, Copy)]
pub(super) struct Image {
    pub(super) m: Mat3,
    pub(super) t: Vec3,
    /// -1 where it mirrors.
    pub(super) hand: f32,
}

impl Image {
    fn about(m: Mat3, point: Vec3) -> Image {
        Image { m, t: point - m * point, hand: m.determinant().signum() }
    }

    fn then(&self, next: &Image) -> Image {
        Image { m: next.m * self.m, t: next.m * self.t + next.t, hand: self.hand * next.hand }
    }

    pub(super) fn at(&self, p: Vec3) -> Vec3 {
        self.m * p + self.t
    }
}

/// All images, the brush itself first; [`IMAGES`] at most.
#[derive(Debug, Clone, Copy)]
pub(super) struct Images {
    list: [Image; IMAGES],
    count: usize,
}

impl Images {
    pub(super) fn of(brush: &BrushSettings, middle: Vec3, extent: f32) -> Images {
        let one = Image { m: Mat3::IDENTITY, t: Vec3::ZERO, hand: 1.0 };
        let mut images = Images { list: [one; IMAGES], count: 1 };
        for axis in 0..3 {
            if brush.symmetry[axis] {
                let mut sign = Vec3::ONE;
                sign[axis] = -1.0;
                images.double(&Image::about(Mat3::from_diagonal(sign), middle));
            }
        }
        if let Some(n) = Vec3::from(brush.mirror.plane).try_normalize() {
            // p - 2 n (n . p): Householder's reflection.
            let m = Mat3::from_cols(
                Vec3::X - n * (2.0 * n.x),
                Vec3::Y - n * (2.0 * n.y),
                Vec3::Z - n * (2.0 * n.z),
            );
            images.double(&Image::about(m, middle + n * (brush.mirror.offset * extent)));
        }
        let turns = usize::from(brush.mirror.radial).max(1);
        let (base, kept) = (images.list, images.count);
        for k in 1..turns {
            let angle = std::f32::consts::TAU * k as f32 / turns as f32;
            let m = match brush.mirror.axis {
                0 => turn_matrix(Vec3::X, angle),
                1 => turn_matrix(Vec3::Y, angle),
                _ => turn_matrix(Vec3::Z, angle),
            };
            let turn = Image::about(m, middle);
            base[..kept].iter().for_each(|i| images.add(i.then(&turn)));
        }
        images
    }

    fn add(&mut self, image: Image) {
        if self.count < IMAGES {
            self.list[self.count] = image;
            self.count += 1;
        }
    }

    fn double(&mut self, by: &Image) {
        for i in 0..self.count {
            self.add(self.list[i].then(by));
        }
    }

    pub(super) fn each(&self) -> &[Image] {
        &self.list[..self.count]
    }
}
