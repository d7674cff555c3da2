//! Scenes of two solids that touch, share faces or cut each other.

use glam::{DMat3, DVec3};

use super::solids::{Solid, cuboid, expected, hollow, prism, regular, revolved};

/// Two solids and what their results must be made of.
pub struct Scene {
    pub name: &'static str,
    pub a: Solid,
    pub b: Solid,
    /// Components of union, intersection, A - B, B - A.
    pub components: [usize; 4],
    /// Faces of the four results, where fewer are not possible.
    pub faces: Option<[usize; 4]>,
}

impl Scene {
    /// Volume and area of the four results. Pieces of A that touch in full faces are one solid: the
    /// faces between them are in no result.
    pub fn wanted(&self) -> [(f64, f64); 4] {
        let mut all = expected(&self.a, &self.b);
        if self.name.contains("goblet") {
            // The stem stands on the foot and carries the cup; two sides each.
            let disc = 0.5 * 16.0 * 0.3f64.powi(2) * (std::f64::consts::TAU / 16.0).sin();
            all[0].1 -= 4.0 * disc;
            all[2].1 -= 4.0 * disc;
        }
        all
    }
}

fn scene(
    name: &'static str,
    a: Solid,
    b: Solid,
    components: [usize; 4],
    faces: Option<[usize; 4]>,
) -> Scene {
    Scene { name, a, b, components, faces }
}

fn goblet() -> Solid {
    // 14 around; foot, stem and cup, each of one piece, standing on each other.
    let foot =
        revolved(&[(0., 0.), (2., 0.), (2., 0.25), (0.5, 0.5), (0., 0.5)], &[&[0, 1, 2, 3, 4]], 16);
    let stem = revolved(&[(0., 0.5), (0.3, 0.5), (0.3, 2.5), (0., 2.5)], &[&[0, 1, 2, 3]], 16);
    let cup = revolved(
        &[(0., 2.5), (1., 2.5), (2., 4.), (2., 6.), (1.75, 6.), (1.75, 4.), (0.75, 3.), (0., 3.)],
        &[&[0, 1, 6, 7], &[1, 2, 5, 6], &[2, 3, 4, 5]],
        16,
    );
    foot.and(stem).and(cup)
}

pub fn scenes() -> Vec<Scene> {
    let cube = || cuboid([0.; 3], [2.; 3]);
    let fork = [(0., 0.), (6., 0.), (6., 3.), (4., 3.), (4., 1.), (2., 1.), (2., 3.), (0., 3.)];
    vec![
        // A block over the two prongs of a fork.
        scene(
            "two contact zones",
            prism(&fork, 0., 2., 2),
            cuboid([1., 3., 0.5], [5., 4., 1.5]),
            [1, 0, 1, 1],
            None,
        ),
        scene(
            "one zone, regular profile",
            cuboid([-3., -3., -1.], [3., 3., 0.]),
            prism(&regular(6, 2., (0., 0.), 0.1), 0., 2., 2),
            [1, 0, 1, 1],
            Some([6 + 6 + 1 + 1, 0, 6, 8]),
        ),
        scene(
            "contact crossed four times",
            cuboid([0., 4., 0.], [10., 6., 1.]),
            cuboid([4., 0., 1.], [6., 10., 2.]),
            [1, 0, 1, 1],
            Some([5 + 5 + 4, 0, 6, 6]),
        ),
        scene(
            "one face against many",
            cuboid([0., 0., 1.], [12., 4., 2.]),
            prism(&regular(3, 1., (2., 2.), 0.3), 0., 1., 2)
                .and(prism(&regular(4, 1., (5., 2.), 0.3), 0., 1., 2))
                .and(prism(&regular(5, 1., (8., 4.), 0.3), 0., 1., 2))
                .and(prism(&regular(7, 1., (12., 0.), 0.3), 0., 1., 2)),
            [1, 0, 1, 4],
            None,
        ),
        scene(
            "small face in a large one, standing",
            cube(),
            cuboid([0.5, 0.5, 2.], [1., 1., 3.]),
            [1, 0, 1, 1],
            Some([5 + 5 + 2, 0, 6, 6]),
        ),
        scene(
            "small face in a large one, sunk",
            cube(),
            cuboid([0.5, 0.5, 1.], [1., 1., 2.]),
            [1, 1, 1, 0],
            Some([6, 6, 5 + 5 + 2, 0]),
        ),
        scene("total overlap", cube(), cube(), [1, 1, 0, 0], Some([6, 6, 0, 0])),
        scene(
            "a wing against a fuselage",
            prism(&regular(24, 1., (0., 0.), 0.05), -4., 4., 0),
            prism(&[(-1., -0.1), (0.2, -0.15), (1., 0.), (0.2, 0.12), (-0.8, 0.1)], 0.8, 5., 1),
            [1, 1, 1, 1],
            None,
        ),
        scene(
            "a goblet on a book",
            goblet(),
            cuboid([-4., -3., -1.], [4., 3., 0.]),
            [1, 0, 1, 1],
            None,
        ),
        scene(
            "a goblet in a box on its floor",
            goblet(),
            hollow([-4., -4., -1.], [4., 4., 8.], 1.),
            [2, 0, 1, 2],
            None,
        ),
        scene(
            "contact touches the border at a point",
            cuboid([0., 0., 0.], [4., 4., 1.]),
            prism(&[(2., 0.), (3., 2.), (2., 3.), (1., 2.)], 1., 2., 2),
            [1, 0, 1, 1],
            None,
        ),
        scene(
            "a cut through vertices",
            prism(&regular(6, 2., (0., 0.), 0.), 0., 2., 2),
            cuboid([-2., 0., 0.], [2., 4., 1.]),
            [1, 1, 1, 1],
            None,
        ),
        scene(
            "a cut through vertices and along an edge",
            prism(&[(0., 0.), (4., 0.), (4., 4.), (0., 4.)], 0., 4., 2),
            prism(&[(0., 0.), (4., 4.), (2., 6.), (-2., 2.)], 0., 4., 2),
            [1, 1, 1, 1],
            None,
        ),
        scene(
            "corner in corner",
            cube(),
            cuboid([1.; 3], [3.; 3]),
            [1, 1, 1, 1],
            Some([12, 6, 9, 9]),
        ),
        scene("face on face", cube(), cuboid([2., 0., 0.], [4., 2., 2.]), [1, 0, 1, 1], None),
        scene(
            "edge on edge",
            cube(),
            cuboid([2., 2., 0.], [4., 4., 2.]),
            [2, 0, 1, 1],
            Some([12, 0, 6, 6]),
        ),
        scene(
            "corner on corner",
            cube(),
            cuboid([2.; 3], [4.; 3]),
            [2, 0, 1, 1],
            Some([12, 0, 6, 6]),
        ),
        scene(
            "a bar through",
            cuboid([0.; 3], [3.; 3]),
            cuboid([1., 1., -1.], [2., 2., 4.]),
            [1, 1, 1, 2],
            None,
        ),
        scene(
            "a slab through",
            cuboid([0.; 3], [3.; 3]),
            cuboid([1., -1., -1.], [2., 4., 4.]),
            [1, 1, 2, 1],
            None,
        ),
    ]
}

pub fn turn(angle: f64) -> DMat3 {
    DMat3::from_axis_angle(DVec3::new(0.3, -0.7, 0.55).normalize(), angle)
}
