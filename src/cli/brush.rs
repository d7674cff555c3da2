//! `sculptd brush list|save|export|import`: a person's own brushes.

use std::path::{Path, PathBuf};

use serde_json::json;

use super::{Fail, Outcome, answer};
use sculptd_clay::brush::{Alpha, BrushKind, OwnBrush, Picture, own_brush};
use sculptd_daemon::brush_folder::{self, BrushFolder, SavedBrush};
use sculptd_geometry::io::read_regular;

#[derive(Debug, clap::Subcommand)]
pub enum BrushCommand {
    /// List all brushes: built-in and your own. Errors in files are printed to standard error.
    List,
    /// Save the brush in hand of the running daemon under a name.
    #[cfg(unix)]
    Save {
        name: String,
        /// One line on what it is for.
        #[arg(long, default_value = "")]
        about: String,
        /// Its position in lists: lower comes first.
        #[arg(long, default_value_t = 0, allow_negative_numbers = true)]
        order: i32,
        /// The picture of heights that goes with it: PNG, JPEG, WebP, TIFF or EXR.
        #[arg(long, value_name = "FILE")]
        picture: Option<PathBuf>,
        /// In the place of the brush that has this name.
        #[arg(long)]
        replace: bool,
        /// The daemon's socket, if it is not at its usual place.
        #[arg(long, value_name = "PATH")]
        socket: Option<PathBuf>,
    },
    /// Write a brush, with its picture, into another folder: one of your own, or one of the
    /// program as a beginning.
    Export {
        name: String,
        /// Made if it is not there.
        folder: PathBuf,
        /// Replace an existing file.
        #[arg(long)]
        replace: bool,
    },
    /// Import brushes, with their pictures, from files.
    Import {
        #[arg(required = true)]
        files: Vec<PathBuf>,
        /// Replace existing brushes of the same names.
        #[arg(long)]
        replace: bool,
    },
}

/// Longest file of a picture, bytes.
const MAX_PICTURE_FILE: u64 = 64 << 20;

fn folder_of(named: Option<&Path>) -> Result<PathBuf, Fail> {
    let none = || Fail::Config("there is no data folder for brushes: name one by --brushes".into());
    named.map(Path::to_path_buf).or_else(brush_folder::default_folder).ok_or_else(none)
}

/// The bytes of a picture, once it is known to be one.
fn picture_bytes(path: &Path) -> Result<Vec<u8>, Fail> {
    let bytes = read_regular(path, MAX_PICTURE_FILE).map_err(|e| Fail::io(path, &e))?;
    let named = |e: String| Fail::Input(format!("{}: {e}", path.display()));
    Picture::decode(&bytes).map_err(named)?;
    Ok(bytes)
}

/// Copies a brush, whose file is in folder `from`, into a folder.
fn copy(brush: &OwnBrush, from: Option<&Path>, to: &Path, replace: bool) -> Result<PathBuf, Fail> {
    let picture = from.zip(brush.picture_file.as_ref()).map(|(from, file)| from.join(file));
    let bytes = picture.as_deref().map(picture_bytes).transpose()?;
    brush_folder::write(to, brush, bytes.as_deref(), replace).map_err(Fail::Input)
}

fn written(paths: &[PathBuf], json: bool) -> Outcome {
    answer(json, &json!({ "written": paths }), |out| {
        paths.iter().try_for_each(|path| writeln!(out, "{}", path.display()))
    });
    Ok(())
}

fn list(folder: &Path, json: bool) -> Outcome {
    let presets = crate::presets().apart();
    let mut own = BrushFolder::new(folder.into(), presets.clone());
    own.refresh();
    let problems = own.problems();
    for problem in &problems {
        eprintln!("sculptd: brush not taken: {problem}");
    }
    let own = presets.own();
    let of_program = BrushKind::ALL.iter().map(
        |kind| json!({ "name": kind.name(), "about": presets.get(*kind).about(), "own": false }),
    );
    let of_person = own.iter().map(|brush| {
        let (kind, picture) = (brush.settings.kind.name(), &brush.picture_file);
        let (name, about) = (&brush.name, &brush.about);
        json!({ "name": name, "about": about, "own": true, "kind": kind, "picture": picture })
    });
    let brushes: Vec<_> = of_program.chain(of_person).collect();
    let found = json!({ "folder": folder, "brushes": brushes, "problems": problems });
    answer(json, &found, |out| {
        for kind in BrushKind::ALL {
            writeln!(out, "{:<20} {}", kind.name(), presets.get(*kind).about())?;
        }
        writeln!(out, "Your own, in {}:", folder.display())?;
        own.iter()
            .try_for_each(|b| writeln!(out, "{:<20} {} ({})", b.name, b.about, b.settings.kind))
    });
    Ok(())
}

/// The brush in the hand of the running daemon.
#[cfg(unix)]
fn in_hand(socket: Option<&Path>) -> Result<sculptd_clay::brush::BrushSettings, Fail> {
    use sculptd_control::client::{ClientError, call, default_path};
    let path = socket.map_or_else(default_path, Path::to_path_buf);
    let patience = std::time::Duration::from_secs(10);
    let status = call(&path, "status", &serde_json::Value::Null, patience);
    let status = status.map_err(|e| match e {
        ClientError::Absent { .. } => Fail::Device(e.to_string()),
        e => Fail::Input(e.to_string()),
    })?;
    serde_json::from_value(status["brush"].clone()).map_err(|e| Fail::Input(e.to_string()))
}

pub fn run(command: &BrushCommand, named: Option<&Path>, json: bool) -> Outcome {
    let folder = folder_of(named)?;
    match command {
        BrushCommand::List => list(&folder, json),
        #[cfg(unix)]
        BrushCommand::Save { name, about, order, picture, replace, socket } => {
            own_brush::check_name(name).map_err(Fail::Usage)?;
            let settings = in_hand(socket.as_deref())?;
            if settings.alpha == Alpha::Picture && picture.is_none() {
                let text = "the brush presses a picture: name its file by --picture";
                return Err(Fail::Usage(text.into()));
            }
            let bytes = picture.as_deref().map(picture_bytes).transpose()?;
            let ending = picture.as_deref().and_then(Path::extension).unwrap_or_default();
            let ending = ending.to_string_lossy();
            let saved = SavedBrush {
                name,
                about,
                order: *order,
                picture: bytes.as_deref().map(|bytes| (&*ending, bytes)),
                replace: *replace,
            };
            let path = brush_folder::save(&folder, &settings, &saved);
            written(&[path.map_err(Fail::Input)?], json)
        }
        BrushCommand::Export { name, folder: to, replace } => {
            let path = folder.join(format!("{name}.toml"));
            let path = match name.parse::<BrushKind>() {
                Ok(kind) => {
                    let preset = crate::presets().get(kind);
                    let brush = OwnBrush {
                        // The brush itself keeps its name.
                        name: format!("my {name}"),
                        about: preset.about().into(),
                        order: 0,
                        settings: preset.settings(),
                        picture_file: None,
                        picture: None,
                    };
                    copy(&brush, None, to, *replace)?
                }
                Err(_) => {
                    own_brush::check_name(name).map_err(Fail::Usage)?;
                    std::fs::metadata(&path).map_err(|e| Fail::io(&path, &e))?;
                    let brush = brush_folder::read(&path, crate::presets());
                    copy(&brush.map_err(Fail::Input)?, Some(&folder), to, *replace)?
                }
            };
            written(&[path], json)
        }
        BrushCommand::Import { files, replace } => {
            // All are read before any is written.
            let read = |path: &PathBuf| {
                std::fs::metadata(path).map_err(|e| Fail::io(path, &e))?;
                brush_folder::read(path, crate::presets()).map_err(Fail::Input)
            };
            let brushes: Vec<OwnBrush> = files.iter().map(read).collect::<Result<_, _>>()?;
            let mut paths = Vec::new();
            for (brush, path) in brushes.iter().zip(files) {
                paths.push(copy(brush, path.parent(), &folder, *replace)?);
            }
            written(&paths, json)
        }
    }
}
