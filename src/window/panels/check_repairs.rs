//! Repairs on the Check page: a button beside the finding of a cavity, a cup or a thin wall; draft,
//! thicker walls, a flat base, a split with pegs, and text.

use super::retopology;
use super::rows;
use super::state::{CheckPage, UiRequest, UiState, View};
use crate::language::tr;
use glam::DVec3;
use sculptd_check::repair::holes::SealedKind;
use sculptd_check::repair::split::MOST_PEGS;
use sculptd_check::{Finding, FindingKind};
use sculptd_daemon::repair_jobs::WantedRepair;

/// The button that repairs a finding at a place of the world. Returns the repair if it was pressed.
/// Nothing is drawn for a finding that no button repairs.
pub fn button(
    ui: &mut egui::Ui,
    page: &CheckPage,
    finding: &Finding,
    place: DVec3,
    free: bool,
) -> Option<WantedRepair> {
    let process = page.process();
    let hole = |kind, least: Option<f64>| page.repairs.hole(kind, place, least.unwrap_or(0.0));
    let (text, tip, repair) = match finding.kind {
        FindingKind::TrappedVolume => (
            tr!("repair-drain"),
            tr!("repair-drain.tip"),
            hole(SealedKind::Trapped, process.and_then(|p| p.trapped)),
        ),
        FindingKind::SuctionCup => (
            tr!("repair-vent"),
            tr!("repair-vent.tip"),
            hole(SealedKind::Cup, process.and_then(|p| p.cup)),
        ),
        FindingKind::ThinWall | FindingKind::ThinPin => (
            tr!("repair-thicken"),
            tr!("repair-thicken.tip"),
            WantedRepair::Thicken(finding.limit?),
        ),
        _ => return None,
    };
    let button = ui.add_enabled(free, egui::Button::new(text));
    button.on_hover_text(tip).clicked().then_some(repair)
}

/// A field for a length, mm.
fn length(value: &mut f64) -> egui::DragValue<'_> {
    egui::DragValue::new(value).range(0.01..=1e6).speed(0.05).suffix(" mm")
}

/// The part of the page with the numbers, and the buttons for what is no single finding.
pub fn ui(ui: &mut egui::Ui, view: &View<'_>, ui_state: &mut UiState, out: &mut Vec<UiRequest>) {
    ui.add_space(6.0);
    rows::folded("repair-heading").show(ui, |ui| {
        let free = !ui_state.joining;
        let page = &mut ui_state.check;
        let choice = &mut page.repairs;
        rows::value(ui, &tr!("repair-diameter"), length(&mut choice.diameter));
        ui.checkbox(&mut choice.inlet, tr!("repair-inlet")).on_hover_text(tr!("repair-inlet.tip"));
        ui.add_space(4.0);
        let angle = egui::DragValue::new(&mut choice.draft).range(0.1..=45.0).speed(0.05);
        rows::value(ui, &tr!("repair-draft-angle"), angle.suffix("°"));
        let button = ui.add_enabled(free, egui::Button::new(tr!("repair-draft")));
        if button.on_hover_text(tr!("repair-draft.tip")).clicked() {
            let wanted = WantedRepair::Draft(page.repairs.draft);
            out.push(UiRequest::Repair(page.repair(wanted)));
        }
        ui.add_space(4.0);
        let choice = &mut page.repairs;
        rows::value(ui, &tr!("repair-wall"), length(&mut choice.wall));
        let button = ui.add_enabled(free, egui::Button::new(tr!("repair-thicken")));
        if button.on_hover_text(tr!("repair-thicken.tip")).clicked() {
            let wanted = WantedRepair::Thicken(page.repairs.wall);
            out.push(UiRequest::Repair(page.repair(wanted)));
        }
        ui.add_space(4.0);
        let choice = &mut page.repairs;
        rows::value(ui, &tr!("repair-base-height"), length(&mut choice.base));
        let base = ui.add_enabled(free, egui::Button::new(tr!("repair-base")));
        if base.on_hover_text(tr!("repair-base.tip")).clicked() {
            let wanted = WantedRepair::Base(page.repairs.base);
            out.push(UiRequest::Repair(page.repair(wanted)));
        }
        ui.add_space(4.0);
        let choice = &mut page.repairs;
        let mut percent = choice.split * 100.0;
        let slider = egui::Slider::new(&mut percent, 1.0..=99.0).suffix(" %");
        rows::slider(ui, slider, &tr!("repair-split-height"));
        choice.split = percent / 100.0;
        let pegs = &mut choice.pegs;
        rows::slider(ui, egui::Slider::new(&mut pegs.most, 0..=MOST_PEGS), &tr!("repair-pegs"));
        rows::value(ui, &tr!("repair-peg-radius"), length(&mut pegs.radius));
        rows::value(ui, &tr!("repair-peg-length"), length(&mut pegs.length));
        rows::value(ui, &tr!("repair-clearance"), length(&mut pegs.clearance));
        let split = ui.add_enabled(free, egui::Button::new(tr!("repair-split")));
        if split.on_hover_text(tr!("repair-split.tip")).clicked() {
            let wanted = page.repairs.split(view.state, page.choice.up);
            out.push(UiRequest::Repair(page.repair(wanted)));
        }
        ui.add_space(4.0);
        let choice = &mut page.repairs;
        ui.label(tr!("repair-text-label"));
        ui.add(egui::TextEdit::singleline(&mut choice.text).desired_width(f32::INFINITY));
        rows::value(ui, &tr!("repair-letter-height"), length(&mut choice.letter_height));
        let relief = egui::DragValue::new(&mut choice.relief).range(-1e3..=1e3).speed(0.05);
        rows::value(ui, &tr!("repair-relief"), relief.suffix(" mm"));
        let any = !choice.text.trim().is_empty() && choice.relief != 0.0;
        let button = ui.add_enabled(free && any, egui::Button::new(tr!("repair-text")));
        if button.on_hover_text(tr!("repair-text.tip")).clicked() {
            let wanted = page.repairs.text(&view.camera);
            out.push(UiRequest::Repair(page.repair(wanted)));
        }
    });
    retopology::progress(ui, ui_state);
}
