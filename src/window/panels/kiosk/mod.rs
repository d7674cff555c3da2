//! The screen of an installation, which replaces the panels: few words, large targets, and a PIN
//! with which staff leave it.

use std::sync::atomic::Ordering::Relaxed;

mod closed;
mod exhibit;
mod farewell;
mod hints;
mod parts;
mod staff;

use egui::{Align2, RichText};

use super::state::action::brush_title;
use super::state::{KioskPad, UiRequest, UiState, View};
use super::{fonts, qr_code, theme};
use crate::language::ENGLISH;
use parts::{Scan, large, place, text_size};
use sculptd_clay::brush::BrushKind;
use sculptd_daemon::kiosk::desk::Screen;
use sculptd_daemon::kiosk::exhibit::ExhibitTool;
use sculptd_daemon::kiosk::{Hint, Language, Stage, View as KioskView};
use sculptd_daemon::qr_code::Invitation;
use sculptd_engine::command::Command;

pub use parts::TARGET;

/// Digits that are taken at most.
const DIGITS: usize = 12;
/// The shorter side of the screen in which everything has room, points: the text grows no further.
const ROOM: f32 = 640.0;
/// Languages that are all shown during a visit; of more the chosen one alone, until it is pressed.
const FEW: usize = 3;

/// Everything over the clay of an installation. Call once a frame.
pub fn ui(
    ui: &mut egui::Ui,
    view: &View<'_>,
    screen: &Screen,
    ui_state: &mut UiState,
    out: &mut Vec<UiRequest>,
) {
    let ctx = ui.ctx().clone();
    if ui_state.applied.is_none() {
        theme::apply(&ctx, ui_state.prefs.light);
        theme::clear(&ctx);
        // Visitors press for as long as they like.
        ctx.options_mut(|o| o.input_options.max_click_duration = f64::INFINITY);
        if screen.show.contrast {
            theme::strong(&ctx);
        }
        ui_state.applied = Some((ui_state.prefs.light, 100));
    }
    // A wall of a screen is seen from further away.
    let short = ctx.content_rect().size().min_elem() * ctx.zoom_factor();
    let scale = ui_state.screen_scale.clamp(1.0, 4.0);
    let zoom = (screen.show.text * scale).min((short / ROOM).max(1.0));
    if (ctx.zoom_factor() - zoom).abs() > 1e-3 {
        ctx.set_zoom_factor(zoom);
    }
    // The menu of the hands speaks the language of the screen, where the window has it.
    let chosen = screen.words.get(ui_state.pad.language).or(screen.words.first());
    let all = view.translations.all();
    let spoken = chosen.and_then(|words| all.iter().find(|t| t.names().0 == words.name));
    ui_state.prefs.language = spoken.map_or(ENGLISH, |t| t.code()).to_owned();
    let offered: Vec<&str> = screen.words.iter().map(|w| w.name.as_str()).collect();
    fonts::speak(&ctx, view.translations, &offered, ui_state);
    let Some(now) = screen.desk.view.lock().ok().and_then(|v| *v) else { return };
    let pad = &mut ui_state.pad;
    // The farewell speaks the visitor's language.
    if pad.visits != now.visits && now.stage != Stage::Farewell {
        *pad = KioskPad { visits: now.visits, ..KioskPad::default() };
    }
    let Some(words) = shown_words(&ctx, screen, pad) else { return };
    let mut scan = Scan::begin(&ctx, screen, pad);
    if scan.pressed && now.stage == Stage::Attract {
        screen.desk.touched.store(true, Relaxed);
    }
    closed::darken(&ctx, &now);
    let whole = ctx.content_rect();
    let mut free = whole;
    if screen.show.seated {
        // The lower half can be reached from a chair.
        free.min.y = free.center().y;
    }
    if now.staff {
        pad.typed = None;
        staff::ui(&ctx, whole, (screen, view), pad, &now, &mut scan);
        ui_state.pad.targets = scan.count;
        return;
    }
    pad.ends = false;
    if now.stage == Stage::Closed {
        closed::ui(&ctx, whole, words, &now);
    } else {
        // During a visit the work needs the room, and an exhibit's form too.
        let many = now.exhibit.is_some() || screen.words.len() > FEW;
        let folded = now.stage == Stage::Working && many && !pad.unfolded;
        languages(&ctx, free, (screen, folded), pad, &mut scan);
    }
    if screen.staff {
        door(&ctx, free, words, &now, screen, pad, &mut scan);
    }
    staff_message(&ctx, free, screen, &mut scan);
    match now.stage {
        Stage::Closed => {}
        Stage::Farewell => farewell::ui(&ctx, free, words, screen, &mut scan),
        Stage::Attract => {
            attract(&ctx, (whole, free), words, &now, screen, &mut scan);
            if let Some(page) = &screen.watch {
                watch(&ctx, whole, words, page);
            }
        }
        Stage::Working => {
            // The keypad needs the room.
            if pad.typed.is_none() {
                exhibit::task(&ctx, whole, words, (screen, &now), pad, &mut scan);
            }
            if view.state.undo_steps == 0 {
                hints::column(&ctx, whole, words, &screen.show.hints);
            }
            let shown = (words, screen, &now);
            tools(&ctx, free, view, shown, pad, (out, &mut scan));
        }
        Stage::Countdown => {
            let text = words.countdown.replace("{seconds}", &now.seconds_left.to_string());
            countdown(&ctx, free, &text, words, screen, &mut scan);
        }
    }
    ui_state.pad.targets = scan.count;
}

/// Returns the words of the chosen language, or else of the first language that the fonts of this
/// machine can draw.
fn shown_words<'a>(
    ctx: &egui::Context,
    screen: &'a Screen,
    pad: &KioskPad,
) -> Option<&'a Language> {
    let chosen = screen.words.get(pad.language).into_iter();
    chosen.chain(&screen.words).find(|words| fonts::can_draw(ctx, &words.all()))
}

/// Invites visitors: to sculpt, to an exhibit, or to choose one; and shows the last work.
fn attract(
    ctx: &egui::Context,
    (whole, free): (egui::Rect, egui::Rect),
    words: &Language,
    now: &KioskView,
    screen: &Screen,
    scan: &mut Scan,
) {
    let hints = &screen.show.hints;
    // What can be pressed stays where it is: the press begins the visit.
    let texts = closed::drifting(ctx, free);
    let work = now.work.filter(|number| *number > 0);
    let work = work.map(|number| words.work.replace("{number}", &number.to_string()));
    match screen.exhibits.as_slice() {
        [] => said(ctx, texts, (work, &words.welcome, &words.turn), (words, hints)),
        [one] => {
            let title = one.manifest.title.get(&words.code);
            said(ctx, texts, (work, title, &words.welcome), (words, hints));
        }
        _ => exhibit::choice(ctx, free, (words, work), now, screen, scan),
    }
    let result = screen.desk.result.lock().ok().and_then(|result| *result);
    if let Some(result) = result {
        place(ctx, "kept", whole, Align2::RIGHT_CENTER, |ui| {
            ui.vertical_centered(|ui| exhibit::result(ui, words, &result));
        });
    }
}

/// The invitation, below the number of the work that is shown, and the hints.
fn said(
    ctx: &egui::Context,
    free: egui::Rect,
    (work, text, below): (Option<String>, &str, &str),
    (words, hints): (&Language, &[Hint]),
) {
    place(ctx, "said", free, Align2::CENTER_BOTTOM, |ui| {
        let most = free.width() - 80.0;
        let widest = text_size(ui, text, 44.0).x.max(text_size(ui, below, 20.0).x);
        ui.set_width(widest.max(hints::width(hints, most)).ceil().min(most));
        ui.vertical_centered(|ui| {
            if let Some(work) = work {
                ui.label(RichText::new(work).size(24.0));
            }
            ui.label(RichText::new(text).size(44.0));
            ui.label(RichText::new(below).size(20.0));
        });
        hints::rows(ui, words, hints);
    });
}

/// The page on which others watch, and take the work home.
fn watch(ctx: &egui::Context, free: egui::Rect, words: &Language, page: &Invitation) {
    let text = if words.watch.is_empty() { &words.fetch } else { &words.watch };
    place(ctx, "watch", free, Align2::LEFT_CENTER, |ui| {
        ui.vertical_centered(|ui| {
            ui.add(egui::Label::new(RichText::new(text).size(20.0)).extend());
            ui.add_space(10.0);
            qr_code::ui(ui, &page.code, 240.0);
        });
    });
}

/// Shows a message of the fleet's staff to people on site, until somebody dismisses it.
fn staff_message(ctx: &egui::Context, free: egui::Rect, screen: &Screen, scan: &mut Scan) {
    let Ok(mut message) = screen.desk.message.lock() else { return };
    let Some(text) = message.clone() else { return };
    let mut close = false;
    place(ctx, "told staff", free, Align2::CENTER_TOP, |ui| {
        ui.horizontal(|ui| {
            ui.set_max_width(free.width() * 0.5);
            ui.label(RichText::new(text).size(22.0));
            close = scan.button(ui, true, large("×", 24.0, TARGET + 8.0));
        });
    });
    if close {
        *message = None;
    }
}

/// Shows the languages, each by its native name; folded, the chosen one alone.
fn languages(
    ctx: &egui::Context,
    free: egui::Rect,
    (screen, folded): (&Screen, bool),
    pad: &mut KioskPad,
    scan: &mut Scan,
) {
    if screen.words.len() < 2 {
        return;
    }
    let name = if folded { "language" } else { "languages" };
    place(ctx, name, free, Align2::LEFT_TOP, |ui| {
        ui.set_max_width(free.width() * 0.6);
        ui.horizontal_wrapped(|ui| {
            ui.style_mut().wrap_mode = Some(egui::TextWrapMode::Extend);
            let chosen = pad.language;
            let shown = screen.words.iter().enumerate();
            let drawn = shown.filter(|(_, l)| fonts::can_draw(ctx, &l.all()));
            for (i, l) in drawn.filter(|(i, _)| !folded || *i == chosen) {
                let button = large(&l.name, 20.0, 130.0).selected(chosen == i);
                if scan.button(ui, true, button) {
                    (pad.language, pad.unfolded) = (i, folded);
                    screen.desk.touched.store(true, Relaxed);
                }
            }
        });
    });
}

/// Tools, one step back, and the end of the visit; over them the choices of an exhibit.
fn tools(
    ctx: &egui::Context,
    free: egui::Rect,
    view: &View<'_>,
    (words, screen, shown): (&Language, &Screen, &KioskView),
    pad: &mut KioskPad,
    (out, scan): (&mut Vec<UiRequest>, &mut Scan),
) {
    let now = view.state.brush;
    let step = exhibit::step_of(screen, shown);
    let tools = step.map_or(&ExhibitTool::USUAL[..], |step| &step.tools);
    place(ctx, "tools", free, Align2::CENTER_BOTTOM, |ui| {
        ui.set_max_width(free.width() - 80.0);
        if screen.show.seated {
            exhibit::choices(ui, words, (screen, shown), pad, scan);
        }
        ui.horizontal_wrapped(|ui| {
            ui.style_mut().wrap_mode = Some(egui::TextWrapMode::Extend);
            for tool in tools {
                let alike = tool.kind == now.kind || adds(tool.kind) && adds(now.kind);
                let signed = tools.iter().filter(|other| other.kind == tool.kind).count() > 1;
                let chosen = alike && (!signed || now.negative == tool.negative);
                let name = tool_name(words, *tool);
                if scan.button(ui, true, large(&name, 24.0, 160.0).selected(chosen)) {
                    let mut brush = match alike {
                        true => now,
                        false => view.presets.switched(&now, tool.kind),
                    };
                    brush.negative = tool.negative;
                    out.push(UiRequest::World(Command::Brush(brush)));
                    screen.desk.touched.store(true, Relaxed);
                }
            }
            ui.separator();
            let undo = large(&words.undo, 24.0, 150.0);
            if scan.button(ui, view.state.undo_steps > 0, undo) {
                out.push(UiRequest::World(Command::Undo));
                screen.desk.touched.store(true, Relaxed);
            }
            if scan.button(ui, true, large(&words.finish, 24.0, 150.0)) {
                screen.desk.finished.store(true, Relaxed);
            }
        });
    });
}

/// Whatever adds or carves is one of two to a visitor, if the installation begins with a brush of
/// its own.
fn adds(kind: BrushKind) -> bool {
    !matches!(kind, BrushKind::Smooth | BrushKind::Grab)
}

/// The name of a tool in the visitor's language.
fn tool_name(words: &Language, tool: ExhibitTool) -> String {
    match tool {
        ExhibitTool::ADD => words.draw.clone(),
        ExhibitTool::CARVE => words.carve.clone(),
        ExhibitTool::SMOOTH => words.smooth.clone(),
        other => brush_title(other.kind),
    }
}

fn countdown(
    ctx: &egui::Context,
    free: egui::Rect,
    text: &str,
    words: &Language,
    screen: &Screen,
    scan: &mut Scan,
) {
    place(ctx, "countdown", free, Align2::CENTER_CENTER, |ui| {
        ui.vertical_centered(|ui| {
            ui.add(egui::Label::new(RichText::new(text).size(32.0)).extend());
            ui.add_space(16.0);
            if scan.button(ui, true, large(&words.go_on, 28.0, 300.0)) {
                screen.desk.touched.store(true, Relaxed);
            }
        });
    });
}

/// A quiet word in a corner, and behind it the keypad.
fn door(
    ctx: &egui::Context,
    free: egui::Rect,
    words: &Language,
    now: &KioskView,
    screen: &Screen,
    pad: &mut KioskPad,
    scan: &mut Scan,
) {
    let locked = now.locked;
    // Two areas: one that grows would be placed by its former size.
    let name = if pad.typed.is_some() { "keypad" } else { "door" };
    place(ctx, name, free, Align2::RIGHT_TOP, |ui| {
        let Some(typed) = &mut pad.typed else {
            // In a row, because in a column its text would be left-aligned.
            if ui.horizontal(|ui| scan.button(ui, true, large(&words.staff, 16.0, 90.0))).inner {
                (pad.typed, pad.wrong_before) = (Some(String::new()), now.wrong);
            }
            return;
        };
        let mut close = false;
        ui.vertical(|ui| {
            // Never the number itself.
            let shown = if typed.is_empty() { "–".to_owned() } else { "•".repeat(typed.len()) };
            ui.label(RichText::new(shown).size(28.0));
            // The line is there without a text too: the keys must not move under a finger.
            let wrong = now.wrong != pad.wrong_before;
            let text = match (locked, wrong) {
                (true, _) => words.locked.as_str(),
                (false, true) => words.wrong_pin.as_str(),
                (false, false) => " ",
            };
            ui.set_max_width(3.0 * (TARGET + 8.0) + 2.0 * ui.spacing().item_spacing.x);
            ui.label(RichText::new(text).size(18.0).color(ui.visuals().warn_fg_color));
            for row in [["1", "2", "3"], ["4", "5", "6"], ["7", "8", "9"], ["×", "0", "OK"]] {
                ui.horizontal(|ui| {
                    for key in row {
                        let button = large(key, 24.0, TARGET + 8.0);
                        let pressed = scan.button(ui, key == "×" || !locked, button);
                        match key {
                            _ if !pressed => {}
                            "×" => close = true,
                            "OK" => {
                                if let Ok(mut line) = screen.desk.typed.lock() {
                                    *line = Some(std::mem::take(typed));
                                }
                            }
                            digit if typed.len() < DIGITS => typed.push_str(digit),
                            _ => {}
                        }
                    }
                });
            }
        });
        if close {
            pad.typed = None;
        }
    });
}
