//! egui panels, a file each: functions from what was published to what is asked. Nothing here
//! changes the world.

pub mod action;
pub mod analysis;
pub mod brush;
pub mod cube;
pub mod curve_stroke;
pub mod devices;
pub mod files;
pub mod hand_menu;
pub mod hints;
pub mod history;
pub mod history_tree;
pub mod kiosk;
pub mod legend;
pub mod look;
pub mod masks;
pub mod measure;
pub mod messages;
pub mod modal;
pub mod preferences;
pub mod pressure_curve;
pub mod radial;
pub mod scene;
pub mod search;
pub mod symmetry;
pub mod theme;
pub mod timing;
pub mod trim;

use std::path::PathBuf;

use glam::Vec3;

use crate::viewer::look::{Look, MATERIALS, Map};
use action::Action;
use sculptd_daemon::Published;
use sculptd_daemon::trim::Part;
use sculptd_engine::camera::Camera;
use sculptd_engine::command::Command;
use sculptd_engine::hand::MenuItem;

/// What panels see.
#[derive(Debug)]
pub struct View<'a> {
    pub state: &'a Published,
    /// What each brush begins with.
    pub presets: &'a sculptd_clay::brush::Presets,
    /// The camera as the window has it: the world's own follows a tick later.
    pub camera: Camera,
    /// One line a device, as the adaptors describe themselves.
    pub devices: &'a [String],
    /// The session's file and whether it is well.
    pub session: Option<&'a str>,
    /// Bytes of pages sent to the card with the last frame.
    pub uploaded: u64,
    pub adapter: &'a str,
    /// What the window measured of itself.
    pub frame: timing::FrameFigures,
    /// Ghosts are performing.
    pub ghosts: bool,
}

/// What a panel asks for.
#[derive(Debug, Clone)]
pub enum UiRequest {
    World(Command),
    /// To a place of the session's history.
    Jump(u64),
    Camera(Camera),
    /// The camera comes to look at this place.
    FlyTo(Vec3),
    WindowState(PathBuf),
    Export(PathBuf),
    /// The thing is joined with the work.
    Join(MenuItem),
    /// What is seen in this part of the view is cut off.
    Trim(Part),
    /// The work one level finer, or coarser.
    Level(bool),
    /// Distances are those to the work as it is now.
    Reference,
    /// The shadow's outline is written.
    Outline(PathBuf),
    /// For the window: dialogs and pictures.
    Do(Action),
}

/// Which page of the right panel is open.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
pub enum Tab {
    #[default]
    Look,
    Scene,
    Walls,
    Measure,
    Files,
    Devices,
    Loop,
    More,
}

const TABS: [(Tab, &str, &str); 8] = [
    (Tab::Look, "Look", "How the clay is shown"),
    (Tab::Scene, "Scene", "A second thing and joining it with the work, levels, trimming"),
    (Tab::Walls, "Walls", "Wall thickness and thin spots"),
    (Tab::Measure, "Size", "Measures, the shadow along a direction, distances to another form"),
    (Tab::Files, "Files", "Open, export, pictures"),
    (Tab::Devices, "Pens", "Devices and their live values"),
    (Tab::Loop, "Loop", "Timing of the loop and of this window"),
    (Tab::More, "More", "Preferences and messages"),
];

/// What the person has set on the window: nothing of the world.
#[derive(Debug, Default)]
pub struct UiState {
    pub look: Look,
    pub prefs: preferences::Preferences,
    pub tab: Tab,
    pub hidden: bool,
    pub search: Option<search::Search>,
    pub radial: Option<egui::Pos2>,
    pub modal: Option<modal::Modal>,
    pub files: files::Files,
    pub messages: Vec<messages::Message>,
    pub walls: analysis::Walls,
    pub devices: devices::Trace,
    /// A Boolean is under way.
    pub joining: bool,
    pub trial: scene::Trial,
    pub trim: Option<trim::Trim>,
    /// The handle of a curve that was held last.
    pub handle: Option<usize>,
    pub sizes: measure::Sizes,
    /// Pictures of steps, by step.
    pub history: Vec<history::Thumb>,
    /// Every place that the session keeps; empty without a session.
    pub places: history_tree::Places,
    /// The screen of an installation.
    pub pad: kiosk::Pad,
    /// A theme and scale that are in force, so that they are set once.
    pub applied: Option<(bool, u32)>,
}

/// Width of either panel, points.
pub const PANEL: f32 = 236.0;
/// Narrower windows, points, have one panel.
const NARROW: f32 = 760.0;

/// Everything over the clay. Call once a frame, inside egui's own.
pub fn all(ui: &mut egui::Ui, view: &View<'_>, desk: &mut UiState, out: &mut Vec<UiRequest>) {
    let ctx = ui.ctx().clone();
    let wanted = (desk.prefs.light, (desk.prefs.scale * 100.0).round() as u32);
    if desk.applied != Some(wanted) {
        theme::apply(&ctx, desk.prefs.light);
        ctx.set_zoom_factor(desk.prefs.scale);
        desk.look.pale = desk.prefs.light;
        desk.applied = Some(wanted);
    }
    desk.devices.feel(view);
    for action in action::pressed(&ctx) {
        act(action, &ctx, view, desk, out);
    }
    modal::ui(&ctx, view, desk, out);
    let narrow = ctx.content_rect().width() < NARROW;
    if !desk.hidden {
        let side = egui::Panel::left("left").exact_size(PANEL).resizable(false);
        side.show(ui, |ui| {
            scrolled(ui, |ui| {
                tools(ui, view, desk, out);
                if narrow {
                    ui.add_space(10.0);
                    pages(ui, view, desk, out);
                }
            });
        });
        if !narrow {
            let side = egui::Panel::right("right").exact_size(PANEL).resizable(false);
            side.show(ui, |ui| scrolled(ui, |ui| pages(ui, view, desk, out)));
        }
    }
    let free = ui.available_rect_before_wrap();
    trim::ui(&ctx, desk, free, out);
    curve_stroke::ui(&ctx, view, desk, free, out);
    hand_menu::ui(&ctx, view, free);
    cube::ui(&ctx, view, free, out);
    legend::ui(&ctx, desk, free);
    hints::ui(&ctx, &desk.prefs.done, view.ghosts, free);
    messages::toast(&ctx, desk, free);
    for action in radial::ui(&ctx, desk).into_iter().chain(search::ui(&ctx, desk)) {
        act(action, &ctx, view, desk, out);
    }
}

fn scrolled(ui: &mut egui::Ui, what: impl FnOnce(&mut egui::Ui)) {
    egui::ScrollArea::vertical().auto_shrink([false, false]).show(ui, |ui| {
        ui.set_max_width(PANEL - 26.0);
        ui.add_space(6.0);
        what(ui);
        ui.add_space(6.0);
    });
}

fn tools(ui: &mut egui::Ui, view: &View<'_>, desk: &mut UiState, out: &mut Vec<UiRequest>) {
    ui.heading("sculptd");
    ui.add_space(6.0);
    brush::ui(ui, view, out);
    ui.add_space(8.0);
    symmetry::ui(ui, view, out);
    ui.add_space(8.0);
    pressure_curve::ui(ui, view, &desk.devices, out);
    ui.add_space(8.0);
    masks::ui(ui, out);
    ui.add_space(8.0);
    history::ui(ui, view, desk, out);
}

fn pages(ui: &mut egui::Ui, view: &View<'_>, desk: &mut UiState, out: &mut Vec<UiRequest>) {
    egui::Grid::new("tabs").num_columns(4).spacing([4.0, 4.0]).show(ui, |ui| {
        for (i, (tab, name, tip)) in TABS.into_iter().enumerate() {
            let button =
                egui::Button::selectable(desk.tab == tab, name).min_size([47.0, 22.0].into());
            if ui.add(button).on_hover_text(tip).clicked() {
                desk.tab = tab;
            }
            if i % 4 == 3 {
                ui.end_row();
            }
        }
    });
    ui.separator();
    match desk.tab {
        Tab::Look => look::ui(ui, desk, out, view),
        Tab::Scene => {
            scene::ui(ui, view, desk, out);
            ui.add_space(8.0);
            trim::levels(ui, view, desk, out);
            ui.add_space(8.0);
            trim::buttons(ui, desk);
        }
        Tab::Walls => analysis::ui(ui, view, desk, out),
        Tab::Measure => measure::ui(ui, view, desk, out),
        Tab::Files => files::ui(ui, view, desk, out),
        Tab::Devices => devices::ui(ui, view, &desk.devices),
        Tab::Loop => timing::ui(ui, view),
        Tab::More => {
            preferences::ui(ui, desk, view);
            ui.add_space(10.0);
            messages::ui(ui, desk);
        }
    }
}

/// Does what an action says, or hands it on.
pub fn act(
    action: Action,
    ctx: &egui::Context,
    view: &View<'_>,
    desk: &mut UiState,
    out: &mut Vec<UiRequest>,
) {
    // Two keys in one frame: the second goes on from the first.
    let asked = out.iter().rev().find_map(|a| match a {
        UiRequest::World(Command::Brush(b)) => Some(*b),
        _ => None,
    });
    let brush = asked.unwrap_or(view.state.brush);
    if let Some(command) = action::on_brush(action, brush) {
        out.push(UiRequest::World(command));
        return;
    }
    let mut camera = view.camera;
    if let Some((yaw, pitch)) = cube::side(action, &camera) {
        (camera.yaw, camera.pitch) = (yaw, pitch);
        out.push(UiRequest::Camera(camera));
        return;
    }
    match action {
        Action::Frame => {
            let (lo, hi) = view.state.mesh.bounds();
            if lo.cmple(hi).all() {
                camera.frame(lo, hi);
                out.push(UiRequest::Camera(camera));
            }
        }
        Action::Perspective => {
            camera.orthographic = !camera.orthographic;
            out.push(UiRequest::Camera(camera));
        }
        Action::Undo => {
            desk.prefs.done.undone = true;
            out.push(UiRequest::World(Command::Undo));
        }
        Action::Redo => out.push(UiRequest::World(Command::Redo)),
        Action::DragRadius => modal::begin(ctx, view, desk, modal::What::Radius),
        Action::DragStrength => modal::begin(ctx, view, desk, modal::What::Strength),
        Action::NextMaterial => desk.look.material = (desk.look.material + 1) % MATERIALS.len(),
        Action::Facets => desk.look.flat = !desk.look.flat,
        Action::Ssao => desk.look.shade = if desk.look.shade > 0.0 { 0.0 } else { 1.0 },
        Action::Wireframe => desk.look.wireframe = !desk.look.wireframe,
        Action::Grid => desk.look.grid = !desk.look.grid,
        Action::Thickness => toggle(&mut desk.look.map, Map::Thickness),
        Action::Distance => toggle(&mut desk.look.map, Map::Distance),
        Action::TrimBox | Action::TrimLine => {
            let shape =
                if action == Action::TrimBox { trim::Shape::Box } else { trim::Shape::Line };
            desk.trim = Some(trim::Trim { shape, from: None });
        }
        Action::TryAdd => desk.trial.turn(MenuItem::Add),
        Action::TryCut => desk.trial.turn(MenuItem::Carve),
        Action::TryKeep => desk.trial.turn(MenuItem::Keep),
        Action::Finer => out.push(UiRequest::Level(true)),
        Action::Coarser => out.push(UiRequest::Level(false)),
        Action::Mask => toggle(&mut desk.look.map, Map::Mask),
        Action::Search => desk.search = desk.search.take().is_none().then(search::Search::default),
        Action::Panels => desk.hidden = !desk.hidden,
        Action::LightOrDark => desk.prefs.light = !desk.prefs.light,
        Action::LargerText => desk.prefs.scale = (desk.prefs.scale + 0.1).min(preferences::SCALE.1),
        Action::SmallerText => {
            desk.prefs.scale = (desk.prefs.scale - 0.1).max(preferences::SCALE.0)
        }
        Action::Hints => desk.prefs.done = hints::Done::default(),
        Action::WindowState | Action::Export | Action::Screenshot | Action::Turntable => {
            out.push(UiRequest::Do(action))
        }
        // Of the brush and of the six sides: done above.
        _ => {}
    }
    ctx.request_repaint();
}

fn toggle(map: &mut Map, to: Map) {
    *map = if *map == to { Map::None } else { to };
}
