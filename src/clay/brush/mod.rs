//! Brushes. A brush is one file here (a type that is a [`Brush`]) and one line in the table below;
//! nothing else knows how many there are. What a brush begins with is a value, [`Presets`]: the
//! defaults of the code, or texts that a program brings along.
//!
//! * [`brush_trait`], [`dab`]: what a brush is. [`tool`]: how a dab and its images are applied.
//!   [`surface_query`]: what a brush may ask first. [`footprint`]: what a dab covers.
//! * [`settings`], [`options`], [`preset`], [`own_brush`], [`falloff`]: what a person sets.
//! * `drag`, `palm`, `push`: the tools of hands, kernels of their own.

pub mod alpha;
pub mod automask;
pub mod brush_trait;
pub(crate) mod cotangent;
pub mod dab;
mod drag;
pub mod falloff;
pub mod footprint;
mod found_path;
pub mod geodesic;
pub mod level;
pub mod mask_all;
pub mod options;
pub mod own_brush;
mod palm;
pub mod placed_stamp;
pub mod preset;
mod push;
pub mod restore;
pub mod settings;
pub mod stamp;
pub mod stroke_param;
pub mod surface_query;
pub mod tool;
pub mod triples;
pub mod weigh;
pub mod weights;

use serde::{Deserialize, Serialize};

pub use alpha::{Alpha, Picture};
pub use brush_trait::Brush;
pub use dab::{Dab, Grip};
pub use drag::Drag;
pub use falloff::Falloff;
pub use gaussian::GaussianBrush;
pub use mask_all::MaskAction;
pub use options::{AutoMask, Measure, Method, Mirror, PathSettings, TopologySettings};
pub use own_brush::OwnBrush;
pub use palm::Palm;
pub use preset::{OwnNumber, Preset, Presets};
pub use push::Push;
pub use settings::{BrushSettings, PressureCurve};
pub use smooth::SmoothBrush;
pub use stamp::{Stamp, StampBy};
pub use surface_query::Scratch;
pub use tool::Tool;

/// Declares the brushes: name, variant, module.
macro_rules! brushes {
    ($($name:literal $variant:ident $module:ident::$brush:ident,)*) => {
        $(pub mod $module;)*

        /// The kind of brush.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
        pub enum BrushKind {
            $(
                #[doc = concat!("`", $name, "`: see `config/brushes/", $name, ".toml`.")]
                #[serde(rename = $name)]
                $variant,
            )*
        }

        impl BrushKind {
            /// Every brush, in the order of the table.
            pub const ALL: &[BrushKind] = &[$(BrushKind::$variant,)*];

            /// As it is written in files and on the command line.
            pub fn name(self) -> &'static str {
                match self { $(BrushKind::$variant => $name,)* }
            }

            /// The numbers that only this brush has, in the order of [`BrushSettings::extra`].
            pub fn own_numbers(self) -> &'static [OwnNumber] {
                match self { $(BrushKind::$variant => <$module::$brush as Brush>::OWN_NUMBERS,)* }
            }

            /// Returns the grip of the brush.
            pub fn grip(self) -> Grip {
                match self { $(BrushKind::$variant => <$module::$brush as Brush>::GRIP,)* }
            }

            /// Returns true if it can be measured on the surface at the start of the stroke.
            pub fn found(self) -> bool {
                match self { $(BrushKind::$variant => <$module::$brush as Brush>::FOUND,)* }
            }

            /// Returns true if triangles under it may be split and collapsed.
            pub fn cuts(self) -> bool {
                match self { $(BrushKind::$variant => <$module::$brush as Brush>::CUTS,)* }
            }

            /// One dab of this brush, and its images.
            pub fn apply(self, dabs: &[Dab<'_>], tool: &mut Tool<'_>) {
                match self { $(BrushKind::$variant => tool.apply::<$module::$brush>(dabs),)* }
                tool.even(dabs);
            }
        }
    };
}

// Sessions know brushes by their place here: new ones come last.
brushes! {
    "gaussian" Gaussian gaussian::GaussianBrush,
    "smooth" Smooth smooth::SmoothBrush,
    "draw" Draw draw::DrawBrush,
    "clay" Clay clay::ClayBrush,
    "clay-strips" ClayStrips clay_strips::ClayStripsBrush,
    "inflate" Inflate inflate::InflateBrush,
    "layer" Layer layer::LayerBrush,
    "crease" Crease crease::CreaseBrush,
    "pinch" Pinch pinch::PinchBrush,
    "blob" Blob blob::BlobBrush,
    "flatten" Flatten flatten::FlattenBrush,
    "fill" Fill fill::FillBrush,
    "scrape" Scrape scrape::ScrapeBrush,
    "trim" Trim trim::TrimBrush,
    "grab" Grab grab::GrabBrush,
    "elastic" Elastic elastic::ElasticBrush,
    "topological" Topological topological::TopologicalBrush,
    "snake-hook" SnakeHook snake_hook::SnakeHookBrush,
    "twist" Twist twist::TwistBrush,
    "thumb" Thumb thumb::ThumbBrush,
    "nudge" Nudge nudge::NudgeBrush,
    "relax" Relax relax::RelaxBrush,
    "mask" Mask mask::MaskBrush,
    "mask-blur" MaskBlur mask_blur::MaskBlurBrush,
    "paint" Paint paint::PaintBrush,
    "texture" Texture texture::TextureBrush,
    "density" Density density::DensityBrush,
    "simplify" Simplify simplify::SimplifyBrush,
    "slide-relax" SlideRelax slide_relax::SlideRelaxBrush,
    "plane" Plane plane::PlaneBrush,
    "multiplane-scrape" MultiplaneScrape multiplane_scrape::MultiplaneScrapeBrush,
    "sharpen" Sharpen sharpen::SharpenBrush,
    "surface-smooth" SurfaceSmooth surface_smooth::SurfaceSmoothBrush,
    "boundary" Boundary boundary::BoundaryBrush,
    "erase-layer" EraseLayer erase_layer::EraseLayerBrush,
    "draw-face-sets" DrawFaceSets draw_face_sets::DrawFaceSetsBrush,
}

// The variants come from a macro, which marks no default.
#[allow(clippy::derivable_impls)]
impl Default for BrushKind {
    fn default() -> Self {
        BrushKind::Draw
    }
}

impl std::str::FromStr for BrushKind {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        BrushKind::ALL.iter().copied().find(|k| k.name() == text).ok_or_else(|| {
            let names: Vec<_> = BrushKind::ALL.iter().map(|k| k.name()).collect();
            format!("no brush '{text}'; there are {}", names.join(", "))
        })
    }
}

impl std::fmt::Display for BrushKind {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name())
    }
}
