//! `sculptd kiosk`: set an installation up; make, try and pack its exhibits, and score a work.

use std::path::{Path, PathBuf};

use serde::Serialize;

use super::kiosk_check;
#[cfg(unix)]
use super::kiosk_setup;
#[cfg(target_os = "linux")]
use super::kiosk_trial;
use super::run::{self as run_command, RunArgs};
use super::{Fail, Outcome, answer};
use crate::settings::LANGUAGES;
use sculptd_daemon::kiosk::exhibit::create::{NewExhibit, create, goal_of};
use sculptd_daemon::kiosk::exhibit::score::Score;
use sculptd_daemon::kiosk::exhibit::{self, Exhibit, Texts, pack};
use sculptd_geometry::io::{MAX_FILE, read_in_millimetres};
use sculptd_geometry::job::Job;

#[derive(Debug, clap::Subcommand)]
pub enum KioskCommand {
    /// Set this computer up as an installation: user, service, screen, devices, log, settings.
    #[cfg(unix)]
    Install(kiosk_setup::InstallArgs),
    /// Remove what `install` wrote. Works, gallery, audit and changed files stay.
    #[cfg(unix)]
    Uninstall(kiosk_setup::UninstallArgs),
    /// Cause faults on the running installation (kill, lost screen, full disk, clock) and print
    /// what happened.
    #[cfg(target_os = "linux")]
    Try(kiosk_trial::TryArgs),
    /// Make an exhibit from a mesh: visitors carve it out of a block, and see how near they are.
    NewExhibit(NewExhibitArgs),
    /// Check an exhibit and print its facts.
    Show {
        /// A folder or .zip file, or figurine, pot or relief.
        exhibit: PathBuf,
    },
    /// Try an exhibit in a window, as a visitor would. Nothing is kept.
    Preview {
        /// A folder or .zip file, or figurine, pot or relief.
        exhibit: PathBuf,
    },
    /// Check the settings of an installation and all that they name, and print what visitors will
    /// find.
    Check {
        /// The file, such as /etc/sculptd/kiosk.toml.
        settings: PathBuf,
    },
    /// Write an exhibit as one .zip file, or as a folder that you can edit.
    Pack {
        /// A folder or .zip file, or figurine, pot or relief.
        exhibit: PathBuf,
        /// The new file, ending in .zip, or else the new folder.
        to: PathBuf,
    },
    /// Score a work against an exhibit's goal, as the screen does.
    Score {
        /// A folder or .zip file, or figurine, pot or relief.
        exhibit: PathBuf,
        /// The work's mesh file.
        work: PathBuf,
        /// The exhibit's step, from 1.
        #[arg(long, value_name = "N", default_value_t = 1)]
        step: usize,
    },
}

#[derive(Debug, clap::Args)]
pub struct NewExhibitArgs {
    /// The mesh that visitors sculpt towards.
    pub goal: PathBuf,
    /// The new exhibit: a .zip file, or else a folder that you can edit.
    #[arg(long, short, value_name = "PACK")]
    pub out: PathBuf,
    /// Title on the screen, in English or, as de=TEXT, in another language; once for each language.
    /// Without it: the name of the mesh file.
    #[arg(long, value_name = "TEXT")]
    pub title: Vec<String>,
    /// The task, in one sentence, in English or, as de=TEXT, in another language; once for each
    /// language. Without one in English, languages left out have a usual sentence.
    #[arg(long, value_name = "TEXT")]
    pub text: Vec<String>,
    /// Tools on the screen, in this order: carve, add, smooth, or brushes by name.
    #[arg(long, value_delimiter = ',', default_value = "carve,add,smooth")]
    pub tools: Vec<String>,
    /// Longest time for a visit, minutes; 0: no limit.
    #[arg(long, default_value_t = 8.0)]
    pub minutes: f64,
    /// Scale the goal's longest side to this length; 0: keep its size.
    #[arg(long, value_name = "MM", default_value_t = 100.0)]
    pub size: f64,
    /// Distance from the goal up to which a place counts as right; 0: a fiftieth of its longest
    /// side.
    #[arg(long, value_name = "MM", default_value_t = 0.0)]
    pub tolerance: f64,
    /// The axis of the file that points up; default: z for STL and 3MF, y for other formats.
    #[arg(long, value_name = "AXIS")]
    pub up: Option<UpAxis>,
}

/// An axis that points up.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum UpAxis {
    Y,
    Z,
}

/// Facts of an exhibit.
#[derive(Debug, Serialize)]
struct ExhibitAnswer {
    name: String,
    title: String,
    minutes: f64,
    start_triangles: usize,
    steps: Vec<StepFacts>,
    /// What was done to the goal.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    notes: Vec<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    file: Option<PathBuf>,
}

#[derive(Debug, Serialize)]
struct StepFacts {
    text: String,
    goal_triangles: Option<usize>,
    tolerance: Option<f64>,
    /// Score of the start.
    at_start: Option<Score>,
}

pub fn run(command: &KioskCommand, json: bool) -> Outcome {
    let job = Job::default();
    match command {
        #[cfg(unix)]
        KioskCommand::Install(args) => return kiosk_setup::install(args, json),
        #[cfg(unix)]
        KioskCommand::Uninstall(args) => return kiosk_setup::uninstall(args, json),
        #[cfg(target_os = "linux")]
        KioskCommand::Try(args) => return kiosk_trial::run(args, json),
        KioskCommand::NewExhibit(args) => {
            let settings = settings(args)?;
            let loaded = read_in_millimetres(&args.goal, MAX_FILE, &job)?;
            let made = create(&loaded.mesh, &settings, &job);
            let at_goal = |e: String| Fail::Input(format!("{}: {e}", args.goal.display()));
            let (exhibit, notes) = made.map_err(at_goal)?;
            pack::write(&exhibit, &args.out).map_err(Fail::Input)?;
            // The facts are read back from the file.
            let written = open(&args.out, &job)?;
            let file = Some(args.out.clone());
            print(&ExhibitAnswer { notes, file, ..facts(&written, &job)? }, json);
        }
        KioskCommand::Show { exhibit } => print(&facts(&open(exhibit, &job)?, &job)?, json),
        KioskCommand::Preview { exhibit } => {
            open(exhibit, &job)?;
            let exhibit = vec![exhibit.clone()];
            let args = RunArgs { kiosk: true, preview: true, exhibit, ..RunArgs::default() };
            return run_command::run(&args, json);
        }
        KioskCommand::Check { settings } => return kiosk_check::run(settings, json),
        KioskCommand::Pack { exhibit, to } => {
            pack::write(&open(exhibit, &job)?, to).map_err(Fail::Input)?;
            let file = Some(to.clone());
            print(&ExhibitAnswer { file, ..facts(&open(to, &job)?, &job)? }, json);
        }
        KioskCommand::Score { exhibit, work, step } => {
            let exhibit = open(exhibit, &job)?;
            let goal = goal_of(&exhibit, *step).map_err(Fail::Usage)?;
            let mesh = read_in_millimetres(work, MAX_FILE, &job)?.mesh.triangulate().0;
            let score = goal.score(&mesh, &job).map_err(|e| Fail::Input(e.to_string()))?;
            answer(json, &score, |out| {
                let (percent, much, little) = (score.percent(), score.too_much, score.too_little);
                writeln!(
                    out,
                    "{percent} % is done; too much up to {much:.3} mm, too little up to \
                     {little:.3} mm"
                )
            });
        }
    }
    Ok(())
}

fn open(place: &Path, job: &Job) -> Result<Exhibit, Fail> {
    exhibit::open(place, job).map_err(Fail::Input)
}

fn settings(args: &NewExhibitArgs) -> Result<NewExhibit, Fail> {
    for (name, value) in [("--size", args.size), ("--tolerance", args.tolerance)] {
        if !(0.0..=1e6).contains(&value) {
            let text = format!("{name} {value}: expected a length from 0 to 1000000");
            return Err(Fail::Usage(text));
        }
    }
    let stem = |path: &Path| path.file_stem().map(|s| s.to_string_lossy().into_owned());
    let extension = args.goal.extension().map(|e| e.to_string_lossy().to_lowercase());
    let prints = extension.is_some_and(|e| matches!(e.as_str(), "stl" | "3mf"));
    Ok(NewExhibit {
        z_up: args.up.map_or(prints, |up| up == UpAxis::Z),
        name: stem(&args.out).unwrap_or_default(),
        title: match args.title.is_empty() {
            true => Texts::new(&stem(&args.goal).unwrap_or_default()),
            false => by_language(&args.title),
        },
        text: by_language(&args.text),
        tools: args.tools.clone(),
        minutes: args.minutes,
        size: args.size,
        tolerance: args.tolerance,
    })
}

/// Texts of the form `de=TEXT`; one without a code is in English.
fn by_language(all: &[String]) -> Texts {
    let one = |text: &String| match text.split_once('=') {
        Some((code, text)) if LANGUAGES.iter().any(|(known, _)| *known == code) => {
            (code.to_owned(), text.to_owned())
        }
        _ => ("en".to_owned(), text.clone()),
    };
    Texts(all.iter().map(one).collect())
}

fn facts(exhibit: &Exhibit, job: &Job) -> Result<ExhibitAnswer, Fail> {
    let mut steps = Vec::new();
    for step in &exhibit.steps {
        let goal = step.goal.as_deref();
        let at_start = goal.map(|goal| goal.score(&exhibit.start, job)).transpose();
        steps.push(StepFacts {
            text: step.text.get("en").to_owned(),
            goal_triangles: goal.map(|goal| goal.mesh.triangles.len()),
            tolerance: goal.map(|goal| goal.tolerance),
            at_start: at_start.map_err(|e| Fail::Input(e.to_string()))?,
        });
    }
    Ok(ExhibitAnswer {
        name: exhibit.name.clone(),
        title: exhibit.manifest.title.get("en").to_owned(),
        minutes: exhibit.manifest.minutes,
        start_triangles: exhibit.start.triangles.len(),
        steps,
        notes: Vec::new(),
        file: None,
    })
}

fn print(facts: &ExhibitAnswer, json: bool) {
    answer(json, facts, |out| {
        writeln!(out, "{}: {}", facts.name, facts.title)?;
        writeln!(out, "  start: {} triangles", facts.start_triangles)?;
        match facts.minutes > 0.0 {
            true => writeln!(out, "  time: {} minutes", facts.minutes)?,
            false => writeln!(out, "  time: no limit")?,
        }
        for (i, step) in facts.steps.iter().enumerate() {
            writeln!(out, "  step {}: {}", i + 1, step.text)?;
            if let (Some(triangles), Some(tolerance), Some(score)) =
                (step.goal_triangles, step.tolerance, &step.at_start)
            {
                writeln!(out, "    goal: {triangles} triangles, right within {tolerance} mm")?;
                let (much, little) = (score.too_much, score.too_little);
                writeln!(
                    out,
                    "    at the start there is too much up to {much:.1} mm, too little up to \
                     {little:.1} mm"
                )?;
            }
        }
        for note in &facts.notes {
            writeln!(out, "  {note}")?;
        }
        if let Some(file) = &facts.file {
            let file = file.display();
            writeln!(out, "written: {file}; try it with `sculptd kiosk preview {file}`")?;
        }
        Ok(())
    });
}
