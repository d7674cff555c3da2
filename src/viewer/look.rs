//! How the clay is shown: materials drawn by formula, facets, cavities. Nothing here changes the world.

/// A material, lit from the eye's own frame. Colours are linear, 0 to 1.
#[derive(Debug, Clone, Copy)]
pub struct Material {
    pub name: &'static str,
    pub base: [f32; 3],
    /// 0 none to 1.
    pub shine: f32,
    /// Exponent of the highlight: larger is smaller and sharper.
    pub power: f32,
    /// Light at grazing angles, 0 none to 1.
    pub rim: f32,
}

const fn material(name: &'static str, base: [f32; 3], shine: f32, power: f32, rim: f32) -> Material {
    Material { name, base, shine, power, rim }
}

pub const MATERIALS: [Material; 7] = [
    material("clay", [0.52, 0.25, 0.165], 0.22, 40.0, 0.25),
    material("porcelain", [0.80, 0.80, 0.78], 0.40, 80.0, 0.20),
    material("wax", [0.60, 0.06, 0.05], 0.45, 50.0, 0.35),
    material("stone", [0.36, 0.37, 0.38], 0.04, 8.0, 0.10),
    material("jade", [0.13, 0.45, 0.24], 0.50, 60.0, 0.45),
    material("bronze", [0.45, 0.25, 0.07], 0.70, 22.0, 0.20),
    material("graphite", [0.09, 0.095, 0.11], 0.55, 28.0, 0.40),
];

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Look {
    /// Index into [`MATERIALS`]; beyond them, the last.
    pub material: usize,
    /// One tone a triangle.
    pub flat: bool,
    /// How strongly hollows are darkened and ridges lightened, 0 none to 2.
    pub cavity: f32,
}

impl Default for Look {
    fn default() -> Self {
        Look { material: 0, flat: false, cavity: 1.0 }
    }
}

impl Look {
    pub fn material(&self) -> &'static Material {
        &MATERIALS[self.material.min(MATERIALS.len() - 1)]
    }
}
