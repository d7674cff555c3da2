//! How the clay is shown: materials drawn by formula, facets, cavities. Nothing here changes the
//! world.

use glam::Vec3;
use sculptd_clay::Ray;
use sculptd_geometry::thickness::MeasuredSide;

/// A material, lit from the eye's own frame. Colours are linear, 0 to 1.
#[derive(Debug, Clone, Copy)]
pub struct Material {
    /// The message of its name.
    pub name: &'static str,
    pub base: [f32; 3],
    /// 0 none to 1.
    pub shine: f32,
    /// Exponent of the highlight: larger is smaller and sharper.
    pub power: f32,
    /// Light at grazing angles, 0 none to 1.
    pub rim: f32,
    /// True for metal, which reflects its surroundings in its colour and scatters nothing.
    pub metal: bool,
}

const fn material(
    name: &'static str,
    base: [f32; 3],
    shine: f32,
    power: f32,
    rim: f32,
) -> Material {
    Material { name, base, shine, power, rim, metal: false }
}

impl Material {
    const fn metal(self) -> Material {
        Material { metal: true, ..self }
    }

    /// Returns its name in commands, such as `bronze`.
    pub fn short_name(&self) -> &'static str {
        self.name.strip_prefix("material-").unwrap_or(self.name)
    }
}

pub const MATERIALS: [Material; 8] = [
    material("material-clay", [0.52, 0.25, 0.165], 0.22, 40.0, 0.25),
    material("material-porcelain", [0.80, 0.80, 0.78], 0.40, 80.0, 0.20),
    material("material-wax", [0.60, 0.06, 0.05], 0.45, 50.0, 0.35),
    material("material-stone", [0.36, 0.37, 0.38], 0.04, 8.0, 0.10),
    material("material-jade", [0.13, 0.45, 0.24], 0.50, 60.0, 0.45),
    material("material-bronze", [0.80, 0.50, 0.22], 1.0, 60.0, 0.20).metal(),
    material("material-graphite", [0.09, 0.095, 0.11], 0.55, 28.0, 0.40),
    material("material-steel", [0.62, 0.63, 0.65], 1.0, 160.0, 0.20).metal(),
];

/// Returns the index in [`MATERIALS`] of a name in commands or settings; an empty one is the first.
pub fn material_index(name: &str) -> Option<usize> {
    match name {
        "" => Some(0),
        name => MATERIALS.iter().position(|material| material.short_name() == name),
    }
}

/// Light source of the clay.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Light {
    /// Two soft lights and a sky, which turn with the eye.
    #[default]
    Studio,
    /// The room that comes with the program.
    Room,
    /// A picture of surroundings.
    Environment,
    /// A picture of a lit ball stands for material and light.
    Matcap,
}

impl Light {
    /// Returns true if light comes from all around.
    pub fn is_around(self) -> bool {
        matches!(self, Light::Room | Light::Environment)
    }
}

/// Map shown instead of the clay's colours.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Map {
    #[default]
    None,
    /// 0 free to 1 fully masked.
    Mask,
    /// Wall thickness in the mesh's unit.
    Thickness,
    /// Width of the gap in front of the surface, in the mesh's unit.
    Gap,
    /// Distance to another form, in the mesh's unit: negative within it, positive outside.
    Distance,
    /// Wall thickness less that of an earlier form, in the mesh's unit.
    WallChange,
    /// Angle of faces that look down, from the vertical, as in the check.
    Overhang,
    /// Angle between faces and the direction in which a mould opens, as in the check.
    Draft,
}

/// Draft of so many degrees above the limit, and more, has the last colour.
const ENOUGH_DRAFT: f32 = 10.0;

/// Limit of a map of angles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AngleMap {
    /// The build direction, or the direction in which a mould opens; in the world, one long.
    pub up: [f32; 3],
    /// Degrees.
    pub limit: f32,
    /// Up to this height along `up` a face is on the plate, and needs no support.
    pub plate: Option<f32>,
}

impl Default for AngleMap {
    fn default() -> Self {
        AngleMap { up: [0.0, 1.0, 0.0], limit: 45.0, plate: None }
    }
}

impl AngleMap {
    /// The angle at which the scale of a map ends, degrees.
    pub fn end(&self, map: Map) -> f32 {
        if map == Map::Draft { (self.limit + ENOUGH_DRAFT).min(90.0) } else { 90.0 }
    }

    /// The limit as the check compares with it, degrees: an angle that differs by less than a
    /// normal's rounding is a tie, which passes.
    pub fn slack_limit(&self, map: Map) -> f32 {
        const SLACK: f32 = 0.01;
        if map == Map::Draft { (self.limit - SLACK).max(0.0) } else { self.limit + SLACK }
    }
}

/// Stops of the distance's scale, sRGB: blue within, pale where both are one, red outside.
const DISTANCE: [[u8; 3]; 5] =
    [[24, 62, 150], [104, 160, 214], [238, 236, 228], [228, 138, 92], [158, 28, 32]];

/// Stops of the scale of angles, sRGB, from far within the limit to it, and from it to far beyond:
/// a step between the two shows where the limit runs.
const WITHIN: [[u8; 3]; 2] = [[196, 206, 214], [238, 228, 170]];
const BEYOND: [[u8; 3]; 2] = [[238, 128, 50], [166, 16, 30]];

/// Stops of the mask's scale, sRGB: free is pale, held is deep blue.
const MASK: [[u8; 3]; 2] = [[232, 226, 214], [28, 52, 110]];
/// Entries of a scale on the card; between them colours are mixed.
pub const SCALE: usize = 8;

fn mixed(a: [u8; 3], b: [u8; 3], x: f32) -> [u8; 3] {
    std::array::from_fn(|k| {
        let (a, b) = (f32::from(a[k]), f32::from(b[k]));
        (a + (b - a) * x).round() as u8
    })
}

impl Map {
    /// Returns true for a map of angles, whose scale has its limit in the middle.
    pub fn is_of_angles(self) -> bool {
        matches!(self, Map::Overhang | Map::Draft)
    }

    /// Returns true for a map of walls or of gaps.
    pub fn is_of_walls(self) -> bool {
        matches!(self, Map::Thickness | Map::Gap | Map::WallChange)
    }

    /// Returns the side of the surface on which a map of walls or of gaps measures.
    pub fn side(self) -> MeasuredSide {
        if self == Map::Gap { MeasuredSide::Gap } else { MeasuredSide::Wall }
    }

    /// Returns true for a map of lengths, which can be shown in steps.
    pub fn has_bands(self) -> bool {
        matches!(self, Map::Thickness | Map::Gap | Map::Distance | Map::WallChange)
    }

    /// The colour of an angle: `x` from 0 to 1 below the limit, or above it.
    fn angle_colour(self, x: f32, above: bool) -> [u8; 3] {
        match (self, above) {
            (Map::Draft, false) => mixed(BEYOND[1], BEYOND[0], x),
            (Map::Draft, true) => mixed(WITHIN[1], WITHIN[0], x),
            (_, false) => mixed(WITHIN[0], WITHIN[1], x),
            (_, true) => mixed(BEYOND[0], BEYOND[1], x),
        }
    }

    /// The colour of a value between the scale's ends; sRGB.
    pub fn colour(self, value: f32, low: f32, high: f32) -> [u8; 3] {
        match self {
            Map::None | Map::Thickness | Map::Gap => {
                sculptd_geometry::thickness::colour::colour(value, low, high)
            }
            Map::Mask => {
                let x = ((value - low) / (high - low).max(1e-12)).clamp(0.0, 1.0);
                mixed(MASK[0], MASK[1], x)
            }
            Map::Distance => {
                let x = ((value - low) / (high - low).max(1e-12)).clamp(0.0, 1.0);
                let at = x * (DISTANCE.len() - 1) as f32;
                let i = (at as usize).min(DISTANCE.len() - 2);
                mixed(DISTANCE[i], DISTANCE[i + 1], at - i as f32)
            }
            Map::WallChange => {
                let x = (value - low) / (high - low).max(1e-12);
                sculptd_geometry::thickness::colour::change_colour(2.0 * x - 1.0, 1.0)
            }
            Map::Overhang | Map::Draft => {
                let x = ((value - low) / (high - low).max(1e-12)).clamp(0.0, 1.0) * 2.0;
                self.angle_colour(if x < 1.0 { x } else { x - 1.0 }, x >= 1.0)
            }
        }
    }

    /// The scale for the card, linear. Of a map of angles the first half is below the limit.
    pub fn scale(self) -> [[f32; 4]; SCALE] {
        if self.is_of_angles() {
            const HALF: usize = SCALE / 2;
            let x = |i: usize| (i % HALF) as f32 / (HALF - 1) as f32;
            return std::array::from_fn(|i| linear(self.angle_colour(x(i), i >= HALF)));
        }
        std::array::from_fn(|i| linear(self.colour(i as f32 / (SCALE - 1) as f32, 0.0, 1.0)))
    }

    /// The message of its name.
    pub fn title(self) -> &'static str {
        match self {
            Map::None => "map-none",
            Map::Mask => "map-mask",
            Map::Thickness => "map-thickness",
            Map::Gap => "map-gap",
            Map::Distance => "map-distance",
            Map::WallChange => "map-wall-change",
            Map::Overhang => "map-overhang",
            Map::Draft => "map-draft",
        }
    }
}

/// From sRGB bytes to linear light.
pub fn linear(c: [u8; 3]) -> [f32; 4] {
    let one = |v: u8| {
        let v = f32::from(v) / 255.0;
        if v <= 0.04045 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) }
    };
    [one(c[0]), one(c[1]), one(c[2]), 1.0]
}

#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(default)]
pub struct Look {
    /// Index into [`MATERIALS`]; beyond them, the last.
    pub material: usize,
    pub light: Light,
    /// Rotation of the studio's main light, or of the surroundings, about the eye's upright axis,
    /// in degrees.
    pub turned: f32,
    /// Elevation of the studio's main light above the eye's horizon, in degrees.
    pub raised: f32,
    /// Share of the studio's main light that a shadow removes: 0 casts none, 1 removes all.
    pub shadow: f32,
    /// Brightness of the surroundings; 1 is as bright as the studio.
    pub bright: f32,
    /// One tone a triangle.
    pub flat: bool,
    /// Strength of darkened hollows and lightened ridges, 0 none to 2.
    pub cavity: f32,
    /// Strength of ambient occlusion, 0 none to 2.
    pub shade: f32,
    /// Edges of triangles over the clay.
    pub wireframe: bool,
    /// The floor under the object.
    pub grid: bool,
    pub map: Map,
    /// The colours of a map of lengths in steps, so that equal walls are seen as equal.
    pub bands: bool,
    /// A pale ground instead of a dark one.
    pub pale: bool,
    /// Face sets of the active object by colours.
    pub sets: bool,
    /// The ends of the map's scale.
    #[serde(skip)]
    pub scale: (f32, f32),
    /// Limit of a map of angles.
    #[serde(skip)]
    pub angles: AngleMap,
    /// The plane in front of which nothing is drawn.
    #[serde(skip)]
    pub cut: Option<CutPlane>,
}

/// A plane across an axis of the world, which cuts off what is seen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CutPlane {
    /// 0 to 2: x, y, z.
    pub axis: usize,
    /// Its place along the axis, in millimetres.
    pub at: f32,
    /// True to cut off what is below the plane instead of what is above.
    pub below: bool,
}

impl CutPlane {
    /// Towards what is cut off, one long, and how far along that the plane is.
    pub fn numbers(self) -> [f32; 4] {
        let sign = if self.below { -1.0 } else { 1.0 };
        let mut plane = [0.0, 0.0, 0.0, sign * self.at];
        plane[self.axis.min(2)] = sign;
        plane
    }

    /// A ray from where it is seen: what is cut off lies behind its origin. `None`: the ray stays
    /// in what is cut off.
    pub fn seen(self, ray: Ray) -> Option<Ray> {
        let [x, y, z, at] = self.numbers();
        let towards = Vec3::new(x, y, z);
        let beyond = ray.origin.dot(towards) - at;
        if beyond <= 0.0 {
            return Some(ray);
        }
        let speed = -ray.dir.dot(towards);
        (speed > 0.0).then(|| Ray { origin: ray.origin + ray.dir * (beyond / speed), ..ray })
    }
}

impl Default for Look {
    fn default() -> Self {
        Look {
            material: 0,
            light: Light::Studio,
            turned: 0.0,
            raised: RAISED,
            shadow: 0.0,
            bright: 1.0,
            flat: false,
            cavity: 0.0,
            shade: 1.0,
            wireframe: false,
            grid: false,
            map: Map::None,
            bands: false,
            pale: false,
            sets: true,
            scale: (0.0, 1.0),
            angles: AngleMap::default(),
            cut: None,
        }
    }
}

/// Default direction of the studio's main light: over the left shoulder. Degrees above the eye's
/// horizon, and radians about its upright axis, measured from the eye.
pub const RAISED: f32 = 40.3;
const AROUND: f32 = -0.628;

impl Look {
    /// Towards the studio's main light, in the eye's own frame (right, up, backward); one long.
    pub fn main_light(&self) -> [f32; 3] {
        let sane = |degrees: f32, or: f32| if degrees.is_finite() { degrees } else { or };
        let raised = sane(self.raised, RAISED).clamp(-90.0, 90.0).to_radians();
        let around = AROUND - sane(self.turned, 0.0).to_radians();
        [raised.cos() * around.sin(), raised.sin(), raised.cos() * around.cos()]
    }

    /// Returns the share of the main light that shadows remove, 0 to 1: 0 if another light, a map
    /// or a cut is shown.
    pub fn cast(&self) -> f32 {
        // What is cut off would still cast a shadow.
        let studio = self.light == Light::Studio && self.map == Map::None && self.cut.is_none();
        if studio && self.shadow.is_finite() { self.shadow.clamp(0.0, 1.0) } else { 0.0 }
    }

    /// The map's scale for the card. The fourth number of the first entry is 0 if it is shown in
    /// steps.
    pub fn card_scale(&self) -> [[f32; 4]; SCALE] {
        let mut scale = self.map.scale();
        if self.bands && self.map.has_bands() {
            scale[0][3] = 0.0;
        }
        scale
    }

    /// The colour of a share of the map's scale, 0 to 1, as the card draws it; sRGB.
    pub fn scale_colour(&self, x: f32) -> [u8; 3] {
        let banded = self.bands && self.map.has_bands();
        let last = (SCALE - 1) as f32;
        let x = if banded { (x * SCALE as f32).floor().clamp(0.0, last) / last } else { x };
        self.map.colour(x, 0.0, 1.0)
    }

    pub fn material(&self) -> &'static Material {
        &MATERIALS[self.material.min(MATERIALS.len() - 1)]
    }
}

/// A colour with that of a face set over it: hues of sets that follow each other are a golden angle
/// apart, so that neighbours differ.
pub fn with_set(colour: [u8; 4], set: u16) -> [u8; 4] {
    if set == 0 {
        return colour;
    }
    let hue = (f32::from(set) * 0.618_034).fract() * 6.0;
    let [r, g, b, a] = colour;
    let tint = [(r, 0.0f32), (g, 4.0), (b, 2.0)].map(|(c, turn)| {
        let wave = (((hue + turn) % 6.0 - 3.0).abs() - 1.0).clamp(0.0, 1.0);
        (f32::from(c) * (0.45 + 0.55 * wave)).round() as u8
    });
    [tint[0], tint[1], tint[2], a]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bands_are_the_colours_of_the_card() {
        let look = Look { map: Map::Thickness, bands: true, ..Look::default() };
        let on_card = Map::Thickness.scale();
        for (i, colour) in on_card.iter().enumerate() {
            for at in [0.01, 0.5, 0.99] {
                let x = (i as f32 + at) / SCALE as f32;
                assert_eq!(linear(look.scale_colour(x)), *colour);
            }
        }
        let smooth = Look { bands: false, ..look };
        assert_ne!(smooth.scale_colour(0.51), smooth.scale_colour(0.55));
        assert_eq!(look.scale_colour(0.51), look.scale_colour(0.55));
    }

    #[test]
    fn a_scale_runs_from_its_low_to_its_high_colour() {
        for map in [
            Map::Mask,
            Map::Thickness,
            Map::Gap,
            Map::Distance,
            Map::WallChange,
            Map::Overhang,
            Map::Draft,
        ] {
            assert_eq!(map.scale()[0], linear(map.colour(0.0, 0.0, 1.0)));
            assert_eq!(map.scale()[SCALE - 1], linear(map.colour(1.0, 0.0, 1.0)));
            assert_ne!(map.scale()[0], map.scale()[SCALE - 1]);
        }
        for map in [Map::Overhang, Map::Draft] {
            assert_ne!(
                map.colour(0.49, 0.0, 1.0),
                map.colour(0.5, 0.0, 1.0),
                "a step at the limit"
            );
            assert_eq!(map.scale()[SCALE / 2], linear(map.colour(0.5, 0.0, 1.0)));
        }
        assert!((linear([188, 0, 255])[0] - 0.503).abs() < 2e-3);
    }
}
