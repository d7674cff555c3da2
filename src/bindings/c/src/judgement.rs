//! Walls judged against limits, across the boundary: the verdict of `sculptd thickness`.

use std::ffi::{CStr, CString, c_char};

use sculptd_geometry::job::Job;
use sculptd_geometry::thickness::ThicknessSettings;
use sculptd_geometry::thickness::check::{ThicknessAnswer, ThicknessLimits, Verdict};
use sculptd_geometry::thickness::preset::{Preset, PresetError};
use sculptd_geometry::thickness::ready::ReadyPart;

use crate::boundary::{
    Failure, SculptdStatus, exclusive, guarded, hand_out, optional, reference, take_back, text,
};
use crate::embedded_presets::WALLS;
use crate::mesh::{SculptdMesh, lend};
use crate::sentences::SculptdSentences;

/// The verdict of limits on a part.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SculptdVerdict {
    /// No limit was given, or nothing could be measured.
    Unjudged = 0,
    /// No wall is proven to be beyond the limits. A limit between the bounds of a certified wall
    /// is a tie, which passes.
    Pass = 1,
    /// A wall is beyond the warning limit.
    Warn = 2,
    /// A wall fails.
    Fail = 3,
    /// The bounds of the least wall are too far apart to compare it with the limit.
    Undecided = 4,
}

/// Limits of wall thickness, mm. 0 sets no limit, and keeps the one of the preset.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct SculptdLimits {
    /// A thinner wall fails.
    pub fail_below: f32,
    /// A thinner wall asks for a second look.
    pub warn_below: f32,
    /// A thicker wall fails.
    pub fail_above: f32,
    /// A larger ratio between neighbouring walls asks for a second look.
    pub neighbour_ratio: f32,
}

/// A verdict with the figures behind it.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct SculptdJudgementFacts {
    /// The verdict.
    pub verdict: SculptdVerdict,
    /// True if the bounds of the least wall are proven over the whole surface.
    pub certified: bool,
    /// True if shells of the part overlapped: their union was measured.
    pub united: bool,
    /// No wall is thinner, mm; NaN where no place has a wall.
    pub least_lower: f64,
    /// Some wall is no thicker, mm; NaN where no place has a wall.
    pub least_upper: f64,
    /// The place of the least wall; NaN where there is none.
    pub least_position: [f64; 3],
    /// The share of the area below the failing limit (or the warning one), 0 to 100; NaN without
    /// such a limit.
    pub below_percent: f64,
    /// The share of the area above the upper limit, 0 to 100; NaN without such a limit.
    pub above_percent: f64,
    /// The limits that the part was compared with; 0 where there was none.
    pub limits: SculptdLimits,
}

/// A region of thin wall.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct SculptdThinPlace {
    /// Of its thinnest place.
    pub position: [f64; 3],
    /// In mm2.
    pub area: f64,
    /// At its thinnest place, mm.
    pub thickness: f32,
}

/// Walls judged against limits. It never changes.
#[derive(Debug)]
pub struct SculptdJudgement {
    answer: ThicknessAnswer,
    statement: CString,
    worst: Vec<SculptdThinPlace>,
    united: bool,
}

/// The limits of a preset that comes with the library.
fn preset_limits(name: &CStr) -> Result<ThicknessLimits, Failure> {
    let defect = |e: PresetError| Failure(SculptdStatus::Defect, e.to_string());
    let presets: Vec<Preset> = WALLS
        .iter()
        .map(|(file, text)| Preset::read(file, text).map_err(defect))
        .collect::<Result<_, Failure>>()?;
    let found = Preset::named(&name.to_string_lossy(), &presets);
    found.map(ThicknessLimits::from).map_err(|e| Failure::argument(e.to_string()))
}

/// Judges the walls of a part in millimetres by one ray along each normal, as `sculptd thickness`
/// does. `preset`: a process or a material ("fdm", "sla", "sls", "abs", "pc", "pp", "pa", "pom") or
/// null. `limits` replace those of the preset, or are null.
///
/// # Safety
/// `mesh` came from this library and was not freed; `preset` is null or ends with a zero; `limits`
/// is null or may be read; `judgement` points to a pointer.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sculptd_judge(
    mesh: *const SculptdMesh,
    preset: *const c_char,
    limits: *const SculptdLimits,
    judgement: *mut *mut SculptdJudgement,
) -> SculptdStatus {
    guarded(|| {
        // SAFETY: as this function's caller promises.
        let (poly, given) = unsafe { (&reference(mesh, "mesh")?.poly, optional(limits)) };
        let mut all = match preset.is_null() {
            true => ThicknessLimits::default(),
            // SAFETY: as this function's caller promises.
            false => preset_limits(unsafe { text(preset, "preset") }?)?,
        };
        if let Some(given) = given {
            let limit = |v: f32| Some(v).filter(|v| *v != 0.0);
            all = all.replaced_by(ThicknessLimits {
                fail_below: limit(given.fail_below),
                warn_below: limit(given.warn_below),
                fail_above: limit(given.fail_above),
                neighbour_ratio: limit(given.neighbour_ratio),
                minimum_area: 0.0,
            });
        }
        if !all.is_valid() {
            return Err(Failure::argument(
                "limits: expected finite numbers above 0, or 0 for none",
            ));
        }
        let (settings, job) = (ThicknessSettings::default(), Job::default());
        let part = ReadyPart::new(poly, 1.0, None, settings.crease, &job)?;
        // The duration is not reported.
        let answer = part.judge("", &settings, all, &job, || 0.0)?.answer;
        let worst = answer.worst.iter().map(|w| SculptdThinPlace {
            position: w.position,
            area: w.area,
            thickness: w.thickness,
        });
        let made = SculptdJudgement {
            worst: worst.collect(),
            statement: CString::new(answer.statement.replace('\0', " ")).unwrap_or_default(),
            united: part.united,
            answer,
        };
        // SAFETY: as this function's caller promises.
        unsafe { hand_out(judgement, made) }
    })
}

/// Writes the verdict and the figures behind it.
///
/// # Safety
/// `judgement` came from this library and was not freed; `facts` may be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sculptd_judgement_facts(
    judgement: *const SculptdJudgement,
    facts: *mut SculptdJudgementFacts,
) -> SculptdStatus {
    guarded(|| {
        // SAFETY: as this function's caller promises.
        let (judgement, facts) =
            unsafe { (reference(judgement, "judgement")?, exclusive(facts, "facts")?) };
        let a = &judgement.answer;
        let limit = |l: Option<f32>| l.unwrap_or(0.0);
        *facts = SculptdJudgementFacts {
            verdict: match a.verdict {
                Verdict::Unjudged => SculptdVerdict::Unjudged,
                Verdict::Pass => SculptdVerdict::Pass,
                Verdict::Warn => SculptdVerdict::Warn,
                Verdict::Fail => SculptdVerdict::Fail,
                Verdict::Undecided => SculptdVerdict::Undecided,
            },
            certified: a.least.is_some_and(|l| l.certified),
            united: judgement.united,
            least_lower: a.least.map_or(f64::NAN, |l| l.lower),
            least_upper: a.least.map_or(f64::NAN, |l| l.upper),
            least_position: a.least.map_or([f64::NAN; 3], |l| l.position),
            below_percent: a.below.map_or(f64::NAN, |b| b.area_percent),
            above_percent: a.above.map_or(f64::NAN, |b| b.area_percent),
            limits: SculptdLimits {
                fail_below: limit(a.limits.fail_below),
                warn_below: limit(a.limits.warn_below),
                fail_above: limit(a.limits.fail_above),
                neighbour_ratio: limit(a.limits.neighbour_ratio),
            },
        };
        Ok(())
    })
}

/// Returns the conclusion in one sentence, which lives as long as the judgement; null for null.
///
/// # Safety
/// `judgement` is null or came from this library and was not freed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sculptd_judgement_statement(
    judgement: *const SculptdJudgement,
) -> *const c_char {
    // SAFETY: as this function's caller promises.
    unsafe { optional(judgement) }.map_or(std::ptr::null(), |j| j.statement.as_ptr())
}

/// Returns at most 10 regions below the limit, the thinnest first, and in `count` their number.
/// Without a limit they are the thinnest hundredth of the area. They live as long as the judgement.
/// Null where there are none, and for null.
///
/// # Safety
/// `judgement` is null or came from this library and was not freed; `count` is null or may be
/// written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sculptd_judgement_worst(
    judgement: *const SculptdJudgement,
    count: *mut usize,
) -> *const SculptdThinPlace {
    // SAFETY: as this function's caller promises.
    let worst = unsafe { optional(judgement) }.map_or(&[][..], |j| &j.worst);
    // SAFETY: as this function's caller promises.
    unsafe { lend(worst, worst.len(), count) }
}

/// Makes a list of the faults of the mesh that the measurement met, one sentence each.
///
/// # Safety
/// `judgement` came from this library and was not freed; `sentences` points to a pointer.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sculptd_judgement_warnings(
    judgement: *const SculptdJudgement,
    sentences: *mut *mut SculptdSentences,
) -> SculptdStatus {
    guarded(|| {
        // SAFETY: as this function's caller promises.
        let warnings = unsafe { &reference(judgement, "judgement")?.answer.warnings };
        // SAFETY: as this function's caller promises.
        unsafe { hand_out(sentences, SculptdSentences::new(warnings)) }
    })
}

/// Frees a judgement; null is good.
///
/// # Safety
/// `judgement` is null or came from this library, and is not used any more.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sculptd_judgement_free(judgement: *mut SculptdJudgement) {
    // SAFETY: as this function's caller promises.
    unsafe { take_back(judgement) }
}
