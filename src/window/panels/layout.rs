//! Where the panels lie: the header above, the brushes at the left, the pages at the right, the
//! status bar below, the rest over the clay.

use super::act::act;
use super::icons::{self, Icon};
use super::state::{Tab, UiRequest, UiState, View};
use super::{
    analysis, brush, check, check_values, chooser, colours, cube, curve_stroke, devices, face_sets,
    files, fonts, hand_menu, header, help, hints, history, keys, layers, legend, light, look,
    masks, measure, messages, modal, outliner, people, preferences, pressure_curve, radial, region,
    remesh, retopology, scene, search, start, status_bar, tablet_keys, theme, timing, trim, views,
};

/// Width of either panel, points.
pub const PANEL: f32 = 252.0;

/// Narrower windows, points, have one panel.
const NARROW: f32 = 760.0;

/// Narrower views, points, have the view cube or the bar of a region, not both.
const ROOM_FOR_CUBE: f32 = 480.0;

/// Everything over the clay, once a frame. Returns the part of the window that the panels leave
/// free, points.
pub fn all(
    ui: &mut egui::Ui,
    view: &View<'_>,
    ui_state: &mut UiState,
    out: &mut Vec<UiRequest>,
) -> egui::Rect {
    let ctx = ui.ctx().clone();
    fonts::speak(&ctx, view.translations, &[], ui_state);
    let wanted = (ui_state.prefs.light, (ui_state.prefs.scale * 100.0).round() as u32);
    if ui_state.applied != Some(wanted) {
        theme::apply(&ctx, ui_state.prefs.light);
        ctx.set_zoom_factor(ui_state.prefs.scale);
        ui_state.look.pale = ui_state.prefs.light;
        ui_state.applied = Some(wanted);
    }
    ui_state.devices.feel(view);
    for action in keys::pressed(&ctx, view, ui_state) {
        act(action, &ctx, view, ui_state, out);
    }
    if ui_state.hidden || ui_state.tab != Tab::Devices {
        tablet_keys::leave(ui_state, out);
    }
    modal::ui(&ctx, view, ui_state, out);
    let narrow = ctx.content_rect().width() < NARROW;
    if !ui_state.hidden {
        let top = egui::Panel::top("header").exact_size(header::HEIGHT).resizable(false);
        top.show(ui, |ui| header::ui(ui, view, ui_state, out));
        let low = egui::Panel::bottom("status").exact_size(status_bar::HEIGHT).resizable(false);
        low.show(ui, |ui| status_bar::ui(ui, view, ui_state));
        // A small window is for the clay first.
        let wide = PANEL.min(ctx.content_rect().width() * 0.56);
        let side = egui::Panel::left("left").exact_size(wide).resizable(false);
        side.show(ui, |ui| {
            scrolled(ui, |ui| {
                tools(ui, view, ui_state, out);
                if narrow {
                    ui.add_space(10.0);
                    pages(ui, view, ui_state, out);
                }
            });
        });
        if !narrow {
            let side = egui::Panel::right("right").exact_size(PANEL).resizable(false);
            side.show(ui, |ui| scrolled(ui, |ui| pages(ui, view, ui_state, out)));
        }
    }
    let free = ui.available_rect_before_wrap();
    // Everything drawn over the clay belongs to the active view.
    let worked_in = views::part(&ctx, view.views, view.views.active(), free);
    ui_state.brush_panel.free = Some(worked_in);
    views::ui(&ctx, view, free, out);
    colours::sampler(&ctx, ui_state, free, out);
    region::ui(&ctx, ui_state, (free, worked_in), out);
    curve_stroke::ui(&ctx, view, ui_state, worked_in, out);
    people::labels(&ctx, view, worked_in);
    hand_menu::ui(&ctx, view, worked_in);
    if ui_state.tab == Tab::Check && !ui_state.hidden {
        check_values::label(&ctx, view, &ui_state.check, worked_in);
    }
    // Its corner belongs to the bar of a region where there is no room for both.
    if ui_state.region.drawing.is_none() || free.width() >= ROOM_FOR_CUBE {
        cube::ui(&ctx, view, free, out);
    }
    legend::ui(&ctx, ui_state, free);
    hints::ui(&ctx, view, ui_state, free);
    light::beside(&ctx, ui_state, free);
    start::ui(&ctx, view, ui_state, free, out);
    chooser::ui(&ctx, ui_state, free, out);
    files::replace(&ctx, ui_state, free, out);
    messages::loading(&ctx, ui_state, free);
    messages::toast(&ctx, ui_state, free);
    keys::ui(&ctx, view, ui_state, free);
    let chosen = [
        radial::ui(&ctx, ui_state),
        search::ui(&ctx, view, ui_state),
        help::ui(&ctx, view, ui_state, free),
    ];
    for action in chosen.into_iter().flatten() {
        act(action, &ctx, view, ui_state, out);
    }
    free
}

fn scrolled(ui: &mut egui::Ui, what: impl FnOnce(&mut egui::Ui)) {
    egui::ScrollArea::vertical().auto_shrink([false, false]).show(ui, |ui| {
        ui.set_max_width(ui.available_width() - 10.0);
        ui.add_space(6.0);
        what(ui);
        ui.add_space(6.0);
    });
}

fn tools(ui: &mut egui::Ui, view: &View<'_>, ui_state: &mut UiState, out: &mut Vec<UiRequest>) {
    brush::ui(ui, view, ui_state, out);
    pressure_curve::ui(ui, view, &ui_state.devices, out);
    masks::ui(ui, view, ui_state, out);
    history::ui(ui, view, ui_state, out);
    people::ui(ui, view);
}

fn icon_of(tab: Tab) -> Icon {
    match tab {
        Tab::Look => Icon::Palette,
        Tab::Scene => Icon::Boxes,
        Tab::Walls => Icon::Layers2,
        Tab::Check => Icon::ShieldCheck,
        Tab::Measure => Icon::Ruler,
        Tab::Files => Icon::FolderOpen,
        Tab::Devices => Icon::PenTool,
        Tab::Loop => Icon::Gauge,
        Tab::More => Icon::Settings,
    }
}

fn pages(ui: &mut egui::Ui, view: &View<'_>, ui_state: &mut UiState, out: &mut Vec<UiRequest>) {
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 0.0;
        let side = (ui.available_width() / Tab::ALL.len() as f32).min(icons::BUTTON);
        for (tab, ..) in Tab::ALL {
            let button = icons::tab(ui, icon_of(tab), &tab.title(), ui_state.tab == tab, side);
            if button.on_hover_text(tab.about()).clicked() {
                ui_state.tab = tab;
            }
        }
    });
    ui.separator();
    // A picture says less than a word to who is new.
    ui.heading(ui_state.tab.title());
    match ui_state.tab {
        Tab::Look => look::ui(ui, ui_state, out, view),
        Tab::Scene => {
            outliner::ui(ui, view, ui_state, out);
            layers::ui(ui, view, ui_state, out);
            face_sets::ui(ui, view, ui_state, out);
            scene::ui(ui, view, ui_state, out);
            ui.add_space(8.0);
            trim::levels(ui, view, ui_state, out);
            ui.add_space(8.0);
            remesh::ui(ui, view, ui_state, out);
            ui.add_space(8.0);
            retopology::ui(ui, view, ui_state, out);
            ui.add_space(8.0);
            trim::buttons(ui, ui_state);
        }
        Tab::Walls => analysis::ui(ui, view, ui_state, out),
        Tab::Check => check::ui(ui, view, ui_state, out),
        Tab::Measure => measure::ui(ui, view, ui_state, out),
        Tab::Files => files::ui(ui, view, ui_state, out),
        Tab::Devices => devices::ui(ui, view, ui_state, out),
        Tab::Loop => timing::ui(ui, view),
        Tab::More => {
            preferences::ui(ui, ui_state, view);
            ui.add_space(10.0);
            messages::ui(ui, ui_state);
        }
    }
}
