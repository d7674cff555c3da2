//! The words and numbers of findings, and the label of the marked one over the clay.

use egui::text::{LayoutJob, TextFormat};
use egui::{Align2, Color32, FontId, Rect, TextStyle, vec2};

use super::measure;
use super::state::{CheckPage, View};
use super::theme;
use crate::language::tr;
use sculptd_check::{CheckAnswer, Finding, FindingKind, Severity};

/// Most digits after the point, where fewer would make a value look like its limit.
const DIGITS: usize = 6;

/// Size of the letters of an advice, as a share of the others.
const ADVICE: f32 = 0.9;

/// A number with at most two digits after the point, without zeros at its end.
pub fn short(x: f64) -> String {
    trimmed(format!("{x:.2}"))
}

fn trimmed(text: String) -> String {
    match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
        false => text,
    }
}

/// Two numbers that differ as texts if they differ at all.
fn apart(a: f64, b: f64) -> (String, String) {
    let at = |digits: usize| (format!("{a:.digits$}"), format!("{b:.digits$}"));
    let differ = (2..=DIGITS).map(at).find(|(a, b)| a != b);
    let (a, b) = differ.unwrap_or_else(|| at(2));
    (trimmed(a), trimmed(b))
}

/// A number with its unit.
fn with_unit(value: String, unit: &str) -> String {
    match unit {
        "mm" => tr!("length-mm", value = value),
        "mm2" => tr!("area-mm2", value = value),
        "mm3" => tr!("volume-mm3", value = value),
        "degrees" => tr!("angle-degrees", value = value),
        "edges" => tr!("check-edges", value = value),
        "pairs" => tr!("check-pairs", value = value),
        "times" => tr!("check-times", value = value),
        "kN" => tr!("check-kilonewtons", value = value),
        _ => value,
    }
}

/// The name of a kind of finding.
pub fn title(kind: FindingKind) -> String {
    tr!(&format!("finding-{}", kind.name()))
}

/// The value of a finding with its unit, and its limit where it has one above 0.
pub fn value(finding: &Finding) -> Option<String> {
    let (value, limit) = (finding.value?, finding.limit.filter(|l| *l > 0.0));
    let Some(limit) = limit else { return Some(with_unit(short(value), finding.unit)) };
    let (value, limit) = apart(value, limit);
    let (value, limit) = (with_unit(value, finding.unit), with_unit(limit, finding.unit));
    Some(tr!("check-value", value = value, limit = limit))
}

/// What to do about a finding.
fn advice(finding: &Finding) -> String {
    match finding.kind {
        FindingKind::NotChecked => finding.message.clone(),
        kind => tr!(&format!("finding-{}.advice", kind.name())),
    }
}

/// A finding as it is listed: its name, value and advice, and its object where there are several.
/// One that is not `present` is of clay that has changed since, and is quiet.
pub fn row(
    ui: &egui::Ui,
    finding: &Finding,
    of: Option<&str>,
    (present, selected): (bool, bool),
) -> LayoutJob {
    let body = TextStyle::Body.resolve(ui.style());
    let small = FontId { size: body.size * ADVICE, ..body.clone() };
    let visuals = ui.visuals();
    let plain = visuals.text_color();
    let (head, rest) = match (present, finding.severity) {
        _ if selected => (visuals.selection.stroke.color, visuals.selection.stroke.color),
        (false, _) => (theme::quiet(ui), theme::quiet(ui)),
        (true, Severity::Error) => (theme::alarm(ui), plain),
        (true, Severity::Warning) => (plain, plain),
    };
    let name = match finding.severity {
        Severity::Error => title(finding.kind),
        Severity::Warning => tr!("check-warning", finding = title(finding.kind)),
    };
    let mut job = LayoutJob::default();
    job.append(&name, 0.0, TextFormat::simple(body.clone(), head));
    let mut line = |text: String, font: &FontId| {
        job.append("\n", 0.0, TextFormat::simple(font.clone(), rest));
        job.append(&text, 0.0, TextFormat::simple(font.clone(), rest));
    };
    value(finding).into_iter().for_each(|v| line(v, &body));
    line(advice(finding), &small);
    of.into_iter().for_each(|name| line(name.to_owned(), &small));
    job
}

/// Width, depth and height of a part as it stands.
pub fn size(answer: &CheckAnswer) -> Option<String> {
    let [x, y, z] = answer.facts.size?.map(short);
    Some(format!("{x} x {y} x {z}"))
}

/// Figures of a part, each with its name.
pub fn facts(answer: &CheckAnswer) -> Vec<(String, String)> {
    let f = &answer.facts;
    [
        (tr!("check-weight"), f.weight.map(|g| tr!("check-grams", value = measure::short(g)))),
        (
            tr!("check-support"),
            f.support_volume.map(|v| tr!("volume-mm3", value = measure::short(v))),
        ),
        (
            tr!("check-time"),
            f.build_time.map(|s| tr!("check-minutes", value = format!("{:.0}", s / 60.0))),
        ),
        (tr!("check-cooling"), f.cooling_time.map(|s| tr!("check-seconds", value = short(s)))),
    ]
    .into_iter()
    .filter_map(|(name, value)| Some((name, value?)))
    .collect()
}

/// The name and value of the marked finding, beside its ring over the clay.
pub fn label(ctx: &egui::Context, view: &View<'_>, page: &CheckPage, free: Rect) {
    let Some((mark, found)) = page.marked.zip(page.shown()) else { return };
    let of = |f: &&Finding| f.kind == mark.kind && f.position == Some(mark.place.to_array());
    let object = found.objects.iter().find(|o| o.id == mark.object);
    let Some(finding) = object.and_then(|o| o.answer.findings.iter().find(of)) else { return };
    let Some(at) = view.camera.project(mark.place.as_vec3()) else { return };
    let at = free.lerp_inside(vec2(at.x, at.y));
    if !free.contains(at) {
        return;
    }
    let mut text = title(mark.kind);
    text.extend(value(finding).map(|v| format!("\n{v}")));
    if !found.is_present(view.state) {
        text.push('\n');
        text.push_str(&tr!("check-before"));
    }
    let layer = egui::LayerId::new(egui::Order::Background, egui::Id::unique("finding"));
    let painter = ctx.layer_painter(layer).with_clip_rect(free);
    let ink = Color32::from_rgb(250, 250, 250);
    let text = painter.layout(text, FontId::proportional(13.0), ink, free.width() * 0.7);
    // Beside the ring; at the other side where there is no room.
    let gap = vec2(free.height() * RING_SHARE * 1.5 + 4.0, 0.0);
    let right = at.x + gap.x + text.size().x + 8.0 < free.right();
    let align = if right { Align2::LEFT_CENTER } else { Align2::RIGHT_CENTER };
    let rect = align.anchor_size(if right { at + gap } else { at - gap }, text.size());
    let room = free.shrink2(vec2(10.0, 8.0)).size() - rect.size();
    if room.min_elem() < 0.0 {
        return;
    }
    let corner = (rect.min - free.min - vec2(10.0, 8.0)).clamp(egui::Vec2::ZERO, room);
    let rect = Rect::from_min_size(free.min + vec2(10.0, 8.0) + corner, rect.size());
    painter.rect_filled(rect.expand2(vec2(6.0, 3.0)), 5.0, Color32::from_rgb(150, 32, 10));
    painter.galley(rect.min, text, ink);
}

/// The part of the view's height that the radius of the mark's ring takes.
pub const RING_SHARE: f32 = 0.035;
