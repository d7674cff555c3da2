//! The command line: one file a subcommand. A subcommand reads its arguments, calls the library and
//! prints; it decides nothing. Standard output carries the answer (with `--json` exactly one
//! object), standard error everything else.

use clap::{CommandFactory, Parser, Subcommand};
use sculptd_daemon::startup::StartupError;
pub use sculptd_mesh_commands::{Fail, Outcome, answer};
use sculptd_mesh_commands::{
    boolean, check, convert, decimate, distance, hollow, info, measure, offset, project, remesh,
    repair, slice, subdivide, thickness,
};

pub mod bench;
pub mod brush;
mod camera;
mod camera_errors;
mod check_presets;
#[cfg(all(test, unix, feature = "viewer", not(feature = "network")))]
mod command_reference;
pub mod config;
#[cfg(unix)]
pub mod ctl;
pub mod demo;
pub mod devices;
pub mod display;
pub mod doctor;
pub mod embedded_presets;
mod ending;
#[cfg(feature = "network")]
pub mod fleet;
#[cfg(feature = "network")]
pub mod fleet_part;
#[cfg(feature = "network")]
pub mod invite;
mod kiosk;
mod kiosk_check;
mod kiosk_settings;
#[cfg(unix)]
mod kiosk_setup;
#[cfg(target_os = "linux")]
mod kiosk_trial;
pub mod library;
mod live;
#[cfg(feature = "network")]
pub mod log_ring;
pub mod logs;
mod man;
mod memory;
#[cfg(feature = "viewer")]
pub mod render;
pub mod replay;
pub mod run;
pub mod session;
#[cfg(feature = "network")]
pub mod shared;
#[cfg(unix)]
pub mod telemetry;
mod thickness_presets;
#[cfg(unix)]
pub mod web_page;
#[cfg(unix)]
pub mod window;
mod window_guard;

#[derive(Debug, Parser)]
#[command(
    name = "sculptd",
    version,
    about = "Sculpt with pen tablets, serial pens and bare hands, in real time"
)]
pub struct Cli {
    /// Print one JSON object on standard output instead of text.
    #[arg(long, global = true)]
    pub json: bool,
    /// The log on standard error: text, or one JSON object a line.
    #[arg(long, global = true, value_enum, value_name = "FORMAT", default_value_t)]
    pub log_format: logs::LogFormat,
    /// Compute as on a processor without AVX2: the same results to the bit, slower. For those who
    /// compare machines.
    #[arg(long, global = true)]
    pub portable: bool,
    #[command(subcommand)]
    pub command: Option<Command>,
}

#[derive(Debug, Subcommand)]
pub enum Command {
    /// The main job with no hardware: simulated devices, through the real parsers, sculpt a form.
    Demo(demo::DemoArgs),
    /// Sculpt: the daemon, with a window where there is a display.
    Run(Box<run::RunArgs>),
    /// Run a session's input once more and print the clay's hash.
    Replay(replay::ReplayArgs),
    /// The facts of mesh files: counts, topology, size, whether they cross themselves.
    Info(info::InfoArgs),
    /// A mesh from one format to another, scaled or mended on the way.
    Convert(convert::ConvertArgs),
    /// Smaller faces and a rounder surface.
    Subdivide(subdivide::SubdivideArgs),
    /// Fewer triangles for nearly the same surface.
    Decimate(decimate::DecimateArgs),
    /// Measure whether this machine holds a mesh at a rate.
    Bench(bench::BenchArgs),
    /// Pens and hands: decode a recording.
    Devices {
        #[command(subcommand)]
        command: devices::DevicesCommand,
    },
    /// Bare hands by webcam: install the hand models, test the camera.
    Camera {
        #[command(subcommand)]
        command: camera::CameraCommand,
    },
    /// An installation: set it up, try its faults, make exhibits.
    Kiosk {
        #[command(subcommand)]
        command: kiosk::KioskCommand,
    },
    /// A picture of a mesh, without a window.
    #[cfg(feature = "viewer")]
    Render(render::RenderArgs),
    /// Ask the running daemon.
    #[cfg(unix)]
    Ctl(ctl::CtlArgs),
    /// Open a window of the running daemon on this screen, if it has none or has lost it.
    #[cfg(unix)]
    Window,
    /// Manage installations remotely: list them, follow them, send them requests, roll out
    /// settings.
    #[cfg(feature = "network")]
    Fleet(fleet::FleetArgs),
    /// Create an invitation to a shared sculpture, as a link and a QR code.
    #[cfg(feature = "network")]
    Invite(invite::InviteArgs),
    /// Check whether this machine can sculpt, and print how to fix what fails.
    Doctor(doctor::DoctorArgs),
    /// Manage session files: list them, show one, remove old ones, salvage a damaged one.
    Session {
        #[command(subcommand)]
        command: session::SessionCommand,
    },
    /// Manage your own brushes: list, save, export and import them.
    Brush {
        /// The folder of your own brushes, if it is not at its usual place.
        #[arg(long, value_name = "FOLDER", global = true)]
        brushes: Option<std::path::PathBuf>,
        #[command(subcommand)]
        command: brush::BrushCommand,
    },
    /// Look at the settings.
    Config {
        #[command(subcommand)]
        command: config::ConfigCommand,
    },
    /// Union, intersection and differences of solids.
    Boolean(boolean::BooleanArgs),
    /// Wall thickness: of every vertex, against limits, as numbers, map and report.
    Thickness(thickness::ThicknessArgs),
    /// Whether a part is ready to print or mould: findings against limits, and how it should stand.
    Check(check::CheckArgs),
    /// Repair a part (flat base, split with pegs, holes, draft, walls, text) and check it again.
    Repair(repair::RepairArgs),
    /// Volume, area, dimensions, projected areas and thickness of a part.
    Measure(measure::MeasureArgs),
    /// Signed distance to a solid, at points or on a grid.
    Distance(distance::DistanceArgs),
    /// A part's shadow along a direction: area, outline, drawing.
    Project(project::ProjectArgs),
    /// Sections of a part by planes: contours, area, perimeter, drawing.
    Slice(slice::SliceArgs),
    /// One closed surface of even triangles out of any mesh.
    Remesh(remesh::RemeshArgs),
    /// Grow or shrink a solid, or melt it together with another.
    Offset(offset::OffsetArgs),
    /// Hollow a part to a wall of stated thickness.
    Hollow(hollow::HollowArgs),
    /// Print completions for a shell.
    Completions { shell: clap_complete::Shell },
    /// Print the manual page, or write those of all subcommands.
    Man {
        /// Write sculptd.1, sculptd-run.1 and all the others into this folder, e.g.
        /// ~/.local/share/man/man1.
        #[arg(long, value_name = "FOLDER")]
        all: Option<std::path::PathBuf>,
    },
}

/// Runs the command line; the process exits with the returned code.
pub fn run() -> u8 {
    let cli = Cli::parse();
    logs::begin(cli.log_format);
    if cli.portable {
        sculptd_geometry::simd::wide::use_portable();
    }
    let outcome = match cli.command {
        Some(Command::Completions { shell }) => {
            clap_complete::generate(shell, &mut Cli::command(), "sculptd", &mut std::io::stdout());
            Ok(())
        }
        Some(Command::Demo(args)) => demo::run(&args, cli.json),
        Some(Command::Run(args)) => run::run(&args, cli.json),
        Some(Command::Bench(args)) => bench::run(&args, cli.json),
        #[cfg(feature = "viewer")]
        Some(Command::Render(args)) => render::run(&args, cli.json),
        Some(Command::Replay(args)) => replay::run(&args, cli.json),
        None => run::run(&run::RunArgs::default(), cli.json),
        #[cfg(unix)]
        Some(Command::Ctl(args)) => ctl::run(&args, cli.json),
        Some(Command::Brush { brushes, command }) => {
            brush::run(&command, brushes.as_deref(), cli.json)
        }
        #[cfg(feature = "network")]
        Some(Command::Fleet(args)) => fleet::run(&args, cli.json),
        #[cfg(feature = "network")]
        Some(Command::Invite(args)) => invite::run(&args, cli.json),
        #[cfg(unix)]
        Some(Command::Window) => window::run(cli.json),
        Some(Command::Config { command }) => config::run(&command, cli.json),
        Some(Command::Doctor(args)) => doctor::run(&args, cli.json),
        Some(Command::Session { command }) => session::run(&command, cli.json),
        Some(Command::Boolean(args)) => boolean::run(&args, cli.json),
        Some(Command::Thickness(args)) => {
            thickness_presets::all().and_then(|presets| thickness::run(&args, &presets, cli.json))
        }
        Some(Command::Check(args)) => {
            check_presets::all().and_then(|library| check::run(&args, &library, cli.json))
        }
        Some(Command::Repair(args)) => {
            check_presets::all().and_then(|library| repair::run(&args, &library, cli.json))
        }
        Some(Command::Measure(args)) => measure::run(&args, cli.json),
        Some(Command::Info(args)) => info::run(&args, cli.json),
        Some(Command::Convert(args)) => convert::run(&args, cli.json),
        Some(Command::Subdivide(args)) => subdivide::run(&args, cli.json),
        Some(Command::Decimate(args)) => decimate::run(&args, cli.json),
        Some(Command::Camera { command }) => camera::run(&command, cli.json),
        Some(Command::Kiosk { command }) => kiosk::run(&command, cli.json),
        Some(Command::Devices { command }) => devices::run(&command, cli.json),
        Some(Command::Distance(args)) => distance::run(&args, cli.json),
        Some(Command::Project(args)) => project::run(&args, cli.json),
        Some(Command::Slice(args)) => slice::run(&args, cli.json),
        Some(Command::Remesh(args)) => remesh::run(&args, cli.json),
        Some(Command::Offset(args)) => offset::run(&args, cli.json),
        Some(Command::Hollow(args)) => hollow::run(&args, cli.json),
        Some(Command::Man { all }) => man::run(all.as_deref(), Cli::command()),
    };
    exit_code(outcome)
}

/// Says what went wrong, if anything did; the exit code.
fn exit_code(outcome: Outcome) -> u8 {
    match outcome {
        Ok(()) => 0,
        Err(fail) => {
            eprintln!("sculptd: {fail}");
            fail.code()
        }
    }
}

/// Why the clay could not be made ready.
pub(crate) fn not_begun(e: StartupError) -> Fail {
    match e {
        StartupError::Read(e) => Fail::from(e),
        StartupError::Build { .. } => Fail::Input(e.to_string()),
    }
}
