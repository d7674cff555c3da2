//! `sculptd render`: a picture of a mesh, by the viewer's own renderer, without a window.

use std::path::{Path, PathBuf};

use serde_json::json;

use super::{Fail, Outcome, answer};
use sculptd_daemon::config::CameraConfig;
use sculptd_daemon::startup;
use sculptd_engine::camera::Camera;
use sculptd_geometry::job::Job;
use sculptd_mesh_commands::picture_size;
use sculptd_window::look::{Light, Look, MATERIALS, RAISED};
use sculptd_window::viewer::look_files::{read_environment, read_matcap};
use sculptd_window::viewer::picture::{Painter, write_png};
use sculptd_window::viewer::renderer::Scene;

#[derive(Debug, clap::Args)]
pub struct RenderArgs {
    pub mesh: PathBuf,
    /// The picture, a PNG.
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    /// Pixels.
    #[arg(long, value_name = "WxH", value_parser = picture_size, default_value = "1280x800")]
    pub size: (u32, u32),
    /// Direction of the camera.
    #[arg(long, value_enum, default_value_t)]
    pub view: ViewFrom,
    /// No perspective.
    #[arg(long)]
    pub orthographic: bool,
    #[arg(long, default_value = "clay", value_parser = materials())]
    pub material: String,
    /// Use a picture of a lit ball as material and light: PNG, JPEG or WebP.
    #[arg(long, value_name = "FILE")]
    pub matcap: Option<PathBuf>,
    /// Light from a picture of surroundings: Radiance HDR or EXR.
    #[arg(long, value_name = "FILE", conflicts_with = "matcap")]
    pub environment: Option<PathBuf>,
    /// Light from the room that comes with the program.
    #[arg(long, conflicts_with_all = ["matcap", "environment"])]
    pub room: bool,
    /// Rotation of the main light, or of the surroundings, about the vertical axis, in degrees.
    #[arg(long, default_value_t = 0.0, allow_negative_numbers = true)]
    pub turned: f32,
    /// Height of the main light above the horizon, in degrees.
    #[arg(long, default_value_t = RAISED, allow_negative_numbers = true)]
    pub raised: f32,
    /// Strength of the main light's shadows: 0 casts none, up to 1.
    #[arg(long, default_value_t = 0.0)]
    pub shadow: f32,
    /// Shade each triangle in one tone.
    #[arg(long)]
    pub flat: bool,
    /// Strength of darkened hollows and lightened ridges, 0 to 2.
    #[arg(long, default_value_t = 1.0)]
    pub cavity: f32,
    /// Strength of ambient occlusion, 0 to 2.
    #[arg(long, default_value_t = 1.0)]
    pub shade: f32,
    /// Draw the edges of triangles.
    #[arg(long)]
    pub wireframe: bool,
    /// Render this number of pictures of a full turn, numbered: NAME-000.png and on.
    #[arg(long, value_name = "FRAMES", value_parser = clap::value_parser!(u32).range(2..=999))]
    pub turntable: Option<u32>,
}

fn materials() -> clap::builder::PossibleValuesParser {
    MATERIALS.map(|m| m.short_name()).into()
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, clap::ValueEnum)]
pub enum ViewFrom {
    #[default]
    Iso,
    Front,
    Back,
    Left,
    Right,
    Top,
    Bottom,
}

impl ViewFrom {
    /// Yaw and pitch in degrees.
    fn angles(self) -> (f32, f32) {
        match self {
            ViewFrom::Iso => (28.0, 20.0),
            ViewFrom::Front => (0.0, 0.0),
            ViewFrom::Back => (180.0, 0.0),
            ViewFrom::Left => (-90.0, 0.0),
            ViewFrom::Right => (90.0, 0.0),
            ViewFrom::Top => (0.0, 89.0),
            ViewFrom::Bottom => (0.0, -89.0),
        }
    }
}

/// Width and height from 16 to 8192, as most adapters allow.
/// `turn.png` becomes `turn-007.png`.
fn numbered(path: &Path, frame: u32) -> PathBuf {
    let stem = path.file_stem().map_or_else(String::new, |s| s.to_string_lossy().into_owned());
    let ending = path.extension().map_or_else(String::new, |e| format!(".{}", e.to_string_lossy()));
    path.with_file_name(format!("{stem}-{frame:03}{ending}"))
}

pub fn run(args: &RenderArgs, as_json: bool) -> Outcome {
    let mut loaded = startup::load(Some(&args.mesh), &Job::default()).map_err(super::not_begun)?;
    let (width, height) = args.size;
    let (yaw, pitch) = args.view.angles();
    let mut camera = CameraConfig {
        yaw_degrees: yaw,
        pitch_degrees: pitch,
        orthographic: args.orthographic,
        aspect: width as f32 / height as f32,
        ..Default::default()
    }
    .camera();
    let snapshot = loaded.mesh.snapshot();
    let (lo, hi) = snapshot.bounds();
    camera.frame(lo, hi);
    let no_adapter = |e: sculptd_window::viewer::NoViewer| Fail::Device(e.to_string());
    let mut painter = Painter::new().map_err(no_adapter)?;
    let unreadable = |e: String| Fail::Input(e);
    let mut light = if args.room { Light::Room } else { Light::Studio };
    if let Some(path) = &args.matcap {
        painter.set_matcap(&read_matcap(path).map_err(unreadable)?);
        light = Light::Matcap;
    }
    if let Some(path) = &args.environment {
        painter.set_environment(&read_environment(path).map_err(unreadable)?);
        light = Light::Environment;
    }
    let look = Look {
        material: MATERIALS.iter().position(|m| m.short_name() == args.material).unwrap_or(0),
        light,
        turned: args.turned,
        raised: args.raised,
        shadow: args.shadow,
        flat: args.flat,
        cavity: args.cavity,
        shade: args.shade,
        wireframe: args.wireframe,
        ..Default::default()
    };
    let frames = args.turntable.unwrap_or(1);
    let mut files = Vec::new();
    for frame in 0..frames {
        let turn = frame as f32 / frames as f32 * std::f32::consts::TAU;
        let camera = Camera { yaw: camera.yaw + turn, ..camera };
        let path = if args.turntable.is_some() {
            numbered(&args.output, frame)
        } else {
            args.output.clone()
        };
        let scene = Scene {
            mesh: &snapshot,
            camera: &camera,
            brush: None,
            lines: &[],
            look,
            values: None,
            beside: Default::default(),
        };
        let picture = painter.paint(&scene, width, height).map_err(no_adapter)?;
        write_png(&path, &picture).map_err(|e| Fail::io(&path, &e))?;
        files.push(path);
    }
    let said = json!({
        "file": files[0],
        "files": files,
        "width": width,
        "height": height,
        "adapter": painter.adapter(),
    });
    answer(as_json, &said, |out| {
        for file in &files {
            writeln!(out, "{} ({width}x{height}, {})", file.display(), painter.adapter())?;
        }
        Ok(())
    });
    Ok(())
}
