//! Repairs on the Check page: a button beside the finding of a cavity or a cup, draft, a flat base,
//! and a split with pegs.

use super::retopology;
use super::rows;
use super::state::{UiRequest, UiState, View};
use crate::language::tr;
use glam::DVec3;
use sculptd_check::repair::holes::SealedKind;
use sculptd_check::repair::split::MOST_PEGS;
use sculptd_check::{Finding, FindingKind};
use sculptd_daemon::repair_jobs::WantedRepair;

/// The void that a hole would open, where a finding is of one.
fn sealed(finding: &Finding) -> Option<SealedKind> {
    match finding.kind {
        FindingKind::TrappedVolume => Some(SealedKind::Trapped),
        FindingKind::SuctionCup => Some(SealedKind::Cup),
        _ => None,
    }
}

/// The button that repairs a finding. Returns the void to open if it was pressed. Nothing is drawn
/// for a finding that no button repairs.
pub fn button(ui: &mut egui::Ui, finding: &Finding, free: bool) -> Option<SealedKind> {
    let kind = sealed(finding)?;
    let (text, tip) = match kind {
        SealedKind::Trapped => (tr!("repair-drain"), tr!("repair-drain.tip")),
        SealedKind::Cup => (tr!("repair-vent"), tr!("repair-vent.tip")),
    };
    let button = ui.add_enabled(free, egui::Button::new(text));
    button.on_hover_text(tip).clicked().then_some(kind)
}

/// The request of a finding's button.
pub fn request(ui_state: &UiState, kind: SealedKind, place: DVec3) -> UiRequest {
    let page = &ui_state.check;
    let limit = page.process().and_then(|p| match kind {
        SealedKind::Trapped => p.trapped,
        SealedKind::Cup => p.cup,
    });
    UiRequest::Repair(page.repair(page.repairs.hole(kind, place, limit.unwrap_or(0.0))))
}

/// A field for a length, mm.
fn length(value: &mut f64) -> egui::DragValue<'_> {
    egui::DragValue::new(value).range(0.01..=1e6).speed(0.05).suffix(" mm")
}

/// The part of the page with the numbers, and the buttons for draft, a flat base and a split.
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
    });
    retopology::progress(ui, ui_state);
}
