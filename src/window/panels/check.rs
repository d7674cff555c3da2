//! Ready to print, ready to mould: what the checks of a process find, the most severe first. A
//! click on a finding flies to its place and marks it.

use std::time::Duration;

use super::act::act;
use super::check_repairs;
use super::check_values;
use super::rows;
use super::state::{Action, CheckPage, CheckStop, MarkedFinding, UiRequest, UiState, View};
use super::theme;
use crate::language::{text_of, tr};
use crate::look::Map;
use glam::DVec3;
use sculptd_check::Severity;
use sculptd_check::preset::BuildMethod;
use sculptd_daemon::repair_jobs::WantedRepair;

/// Interval at which the progress is redrawn, while a check runs.
const LOOK: Duration = Duration::from_millis(100);
/// Findings listed at most.
const LISTED: usize = 100;
/// Build directions that have names.
const AXES: [(DVec3, &str); 6] = [
    (DVec3::Y, "+y"),
    (DVec3::NEG_Y, "-y"),
    (DVec3::X, "+x"),
    (DVec3::NEG_X, "-x"),
    (DVec3::Z, "+z"),
    (DVec3::NEG_Z, "-z"),
];

pub fn ui(ui: &mut egui::Ui, view: &View<'_>, ui_state: &mut UiState, out: &mut Vec<UiRequest>) {
    ui.strong(tr!("check-heading"));
    choice(ui, &mut ui_state.check);
    ui.add_space(4.0);
    maps(ui, view, ui_state, out);
    ui.add_space(8.0);
    let page = &mut ui_state.check;
    status(ui, view, page, out);
    let wanted = findings(ui, view, ui_state, out);
    out.extend(wanted.map(|w| UiRequest::Repair(ui_state.check.repair(w))));
    facts(ui, view, &ui_state.check);
    check_repairs::ui(ui, view, ui_state, out);
}

/// Process, machine, material, objects and direction.
fn choice(ui: &mut egui::Ui, page: &mut CheckPage) {
    let name = |id: &str, title: &str| text_of(&format!("process-{id}"), title);
    let now = page.process().map_or(String::new(), |p| name(&p.name, &p.title));
    let mut chosen = page.choice.process.clone();
    rows::list(ui, &tr!("walls-process"), now, |ui| {
        for p in page.processes() {
            let title = name(&p.name, &p.title);
            ui.selectable_value(&mut chosen, p.name.clone(), title).on_hover_text(&p.source);
        }
    });
    page.choose_process(&chosen);
    let none = tr!("none");
    let printer = |id: &str, title: &str| text_of(&format!("check-printer-{id}"), title);
    let mut chosen = page.choice.printer.clone();
    let now = page.printers().find(|p| chosen.as_ref() == Some(&p.name));
    let now = now.map_or(none.clone(), |p| printer(&p.name, &p.title));
    rows::list(ui, &tr!("check-printer"), now, |ui| {
        ui.selectable_value(&mut chosen, None, none);
        for p in page.printers() {
            let title = printer(&p.name, &p.title);
            ui.selectable_value(&mut chosen, Some(p.name.clone()), title).on_hover_text(&p.source);
        }
    });
    page.choice.printer = chosen;
    let material = |id: &str, title: &str| text_of(&format!("check-material-{id}"), title);
    let mut chosen = page.choice.material.clone();
    let usual = page.process().map_or(String::new(), |p| p.material.clone());
    let named = chosen.as_ref().unwrap_or(&usual);
    let now = page.materials().find(|m| m.name == *named);
    let now = now.map_or(String::new(), |m| material(&m.name, &m.title));
    rows::list(ui, &tr!("check-material"), now, |ui| {
        for m in page.materials() {
            let title = material(&m.name, &m.title);
            let own = (m.name != usual).then(|| m.name.clone());
            ui.selectable_value(&mut chosen, own, title).on_hover_text(&m.source);
        }
    });
    page.choice.material = chosen;
    rows::flow(ui, |ui| {
        ui.radio_value(&mut page.choice.visible, false, tr!("check-active"));
        ui.radio_value(&mut page.choice.visible, true, tr!("check-visible"))
            .on_hover_text(tr!("check-visible.tip"));
    });
    direction(ui, page);
}

/// The build direction, or the one in which a mould opens.
fn direction(ui: &mut egui::Ui, page: &mut CheckPage) {
    let mould = page.process().is_some_and(|p| p.method == BuildMethod::Mould);
    let label = if mould { tr!("check-opens") } else { tr!("check-up") };
    let named = |axis: DVec3, name: &str| match axis == DVec3::Y {
        true => tr!("check-upright", axis = name),
        false => name.to_owned(),
    };
    let up = page.choice.up;
    let now = match AXES.iter().find(|(axis, _)| *axis == up) {
        Some((axis, name)) => named(*axis, name),
        None => format!("({:.2}, {:.2}, {:.2})", up.x, up.y, up.z),
    };
    rows::list(ui, &label, now, |ui| {
        for (axis, name) in AXES {
            ui.selectable_value(&mut page.choice.up, axis, named(axis, name));
        }
    });
    let tip = if mould { tr!("check-best.mould") } else { tr!("check-best.tip") };
    if ui.button(tr!("check-best")).on_hover_text(tip).clicked() {
        page.searches = true;
    }
}

/// The maps on the clay that belong to the process.
fn maps(ui: &mut egui::Ui, view: &View<'_>, ui_state: &mut UiState, out: &mut Vec<UiRequest>) {
    for (action, map) in [(Action::Overhang, Map::Overhang), (Action::DraftAngle, Map::Draft)] {
        let mut on = ui_state.look.map == map;
        let button = ui.checkbox(&mut on, action.title());
        if button.on_hover_text(view.tip(action)).changed() {
            act(action, &ui.ctx().clone(), view, ui_state, out);
        }
    }
    let (map, page) = (ui_state.look.map, &ui_state.check);
    if let Some((limit, process)) = page.angle_limit(map)
        && process.name != page.choice.process
    {
        let name = text_of(&format!("process-{}", process.name), &process.title);
        let limit = check_values::short(limit);
        let text = tr!("check-other-limit", limit = limit, process = name);
        ui.colored_label(theme::quiet(ui), text);
    }
}

/// How the part stands: the result with the clay that it is of, or why there is none.
fn status(ui: &mut egui::Ui, view: &View<'_>, page: &CheckPage, out: &mut Vec<UiRequest>) {
    let quiet = theme::quiet(ui);
    if let Some(running) = &page.under_way {
        let (ended, all) = running.progress.count();
        ui.horizontal(|ui| {
            let share = ended as f32 / all.max(1) as f32;
            let text = tr!("check-progress", ended = ended, all = all);
            ui.add(egui::ProgressBar::new(share).desired_width(130.0).text(text));
            if ui.button(tr!("cancel")).clicked() {
                out.push(UiRequest::CancelCheck);
            }
        });
        ui.ctx().request_repaint_after(LOOK);
    }
    match &page.stopped {
        Some(CheckStop::Cancelled) => {
            ui.colored_label(theme::alarm(ui), tr!("check-cancelled"));
        }
        Some(CheckStop::Failed(why)) => {
            ui.colored_label(theme::alarm(ui), tr!("check-failed", why = why.as_str()));
        }
        None => {}
    }
    let Some(found) = page.shown() else {
        if page.under_way.is_none() {
            if page.stopped.is_none() {
                ui.colored_label(quiet, tr!("check-waits"));
            } else if ui.button(tr!("check-again")).clicked() {
                out.push(UiRequest::CheckAgain);
            }
        }
        return;
    };
    let (errors, warnings) = (found.count(Severity::Error), found.count(Severity::Warning));
    let counts = tr!("check-counts", errors = errors, warnings = warnings);
    let revision = match &found.versions[..] {
        [one] => one.clay.1.to_string(),
        _ => String::new(),
    };
    match (found.is_present(view.state), found.objects.len()) {
        (_, 0) => {
            ui.colored_label(quiet, tr!("check-nothing"));
            return;
        }
        (true, objects) => {
            match found.passes() {
                true => ui.strong(tr!("check-passed")),
                false => ui.colored_label(theme::alarm(ui), tr!("check-not-passed")),
            };
            ui.label(counts);
            ui.colored_label(
                quiet,
                match objects {
                    1 => tr!("check-present", revision = revision),
                    _ => tr!("check-present-objects", count = objects),
                },
            );
        }
        (false, _) => {
            ui.colored_label(theme::alarm(ui), tr!("check-stale"));
            ui.colored_label(quiet, counts);
        }
    }
    if page.under_way.is_none()
        && ui.button(tr!("check-again")).on_hover_text(tr!("check-again.tip")).clicked()
    {
        out.push(UiRequest::CheckAgain);
    }
}

/// The list; each row is a button that flies to its place, where it has one. Returns the repair
/// that a person asked for.
fn findings(
    ui: &mut egui::Ui,
    view: &View<'_>,
    ui_state: &mut UiState,
    out: &mut Vec<UiRequest>,
) -> Option<WantedRepair> {
    let free = !ui_state.joining;
    let page = &mut ui_state.check;
    let found = page.shown()?;
    let active = view.state.scene.active().map(|o| o.id);
    let mut wanted = None;
    let (all, present) = (found.by_severity(), found.is_present(view.state));
    let several = found.objects.len() > 1;
    let mut marked = page.marked;
    ui.add_space(6.0);
    for at in all.iter().take(LISTED) {
        let Some((object, finding)) = found.finding(*at) else { continue };
        let of = several.then_some(object.name.as_str());
        let Some(place) = finding.position.map(DVec3::from) else {
            ui.label(check_values::row(ui, finding, of, (present, false)));
            continue;
        };
        let mark = MarkedFinding { object: object.id, kind: finding.kind, place };
        let selected = page.marked == Some(mark);
        let text = check_values::row(ui, finding, of, (present, selected));
        let layout = egui::Layout::top_down_justified(egui::Align::LEFT);
        let button = egui::Button::selectable(selected, text).wrap();
        let button = ui.with_layout(layout, |ui| ui.add(button)).inner;
        if button.on_hover_text(tr!("walls-spot.tip")).clicked() {
            marked = Some(mark);
            out.push(UiRequest::FlyTo(place.as_vec3()));
        }
        if present && Some(object.id) == active {
            let pressed =
                ui.push_id(*at, |ui| check_repairs::button(ui, page, finding, place, free)).inner;
            wanted = pressed.or(wanted);
        }
    }
    if all.len() > LISTED {
        ui.colored_label(theme::quiet(ui), tr!("check-more", count = all.len() - LISTED));
    }
    for warning in found.objects.iter().flat_map(|o| &o.answer.warnings) {
        ui.colored_label(theme::quiet(ui), warning);
    }
    page.marked = marked;
    wanted
}

/// Figures of the part, if they are of one object as it is now.
fn facts(ui: &mut egui::Ui, view: &View<'_>, page: &CheckPage) {
    let found = page.shown().filter(|f| f.is_present(view.state));
    let Some([object]) = found.map(|f| &f.objects[..]) else { return };
    let quiet = theme::quiet(ui);
    ui.add_space(6.0);
    if let Some(size) = check_values::size(&object.answer) {
        rows::flow(ui, |ui| {
            ui.colored_label(quiet, tr!("check-size"));
            ui.monospace(size);
        });
    }
    egui::Grid::new("check").num_columns(2).spacing([10.0, 3.0]).show(ui, |ui| {
        for (name, value) in check_values::facts(&object.answer) {
            ui.colored_label(quiet, name);
            ui.monospace(value);
            ui.end_row();
        }
    });
}
