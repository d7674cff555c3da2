//! An exhibit on the screen: the choice, the task, how near the work is, the result.

use std::sync::atomic::Ordering::Relaxed;

use egui::{Align2, Color32, ColorImage, Id, RichText, TextureHandle, TextureOptions, vec2};

use super::parts::{Scan, large, place, text_size};
use crate::look::Map;
use crate::panels::state::KioskPad;
use sculptd_daemon::kiosk::desk::{Screen, VisitResult};
use sculptd_daemon::kiosk::exhibit::score::Score;
use sculptd_daemon::kiosk::exhibit::{Exhibit, ExhibitStep};
use sculptd_daemon::kiosk::{Language, View};

/// Width of an exhibit to choose, points.
const CARD: f32 = 190.0;
/// Width of the task and its figures, points.
const FIGURES: f32 = 300.0;

/// The step of the exhibit that is shown; `None`: free sculpting.
pub(super) fn step_of<'a>(screen: &'a Screen, now: &View) -> Option<&'a ExhibitStep> {
    screen.exhibits.get(now.exhibit?)?.steps.get(now.step)
}

/// Shows all exhibits; a press on one begins a visit with it.
pub(super) fn choice(
    ctx: &egui::Context,
    free: egui::Rect,
    (words, work): (&Language, Option<String>),
    now: &View,
    screen: &Screen,
    scan: &mut Scan,
) {
    place(ctx, "choice", free, Align2::CENTER_BOTTOM, |ui| {
        let gap = ui.spacing().item_spacing.x;
        let fits = ((free.width() - 80.0 + gap) / (CARD + gap)).floor().max(1.0) as usize;
        let fits = fits.min(screen.exhibits.len());
        ui.set_width(CARD * fits as f32 + gap * (fits - 1) as f32);
        ui.vertical_centered(|ui| {
            if let Some(work) = work {
                ui.label(RichText::new(work).size(24.0));
            }
            ui.label(RichText::new(&words.choose).size(30.0));
        });
        let all: Vec<_> = screen.exhibits.iter().enumerate().collect();
        for row in all.chunks(fits) {
            ui.horizontal_top(|ui| {
                for (i, exhibit) in row {
                    ui.vertical(|ui| {
                        ui.set_width(CARD);
                        if card(ui, (words, exhibit), now.exhibit == Some(*i), scan) {
                            screen.desk.choose(*i);
                        }
                    });
                }
            });
        }
    });
}

/// A picture with the title below it; whether one of them was pressed.
fn card(
    ui: &mut egui::Ui,
    (words, exhibit): (&Language, &Exhibit),
    shown: bool,
    scan: &mut Scan,
) -> bool {
    let title = exhibit.manifest.title.get(&words.code);
    let picture = texture(ui.ctx(), exhibit);
    let [width, height] = picture.size();
    let size = vec2(CARD, CARD * height as f32 / width.max(1) as f32);
    let image = egui::Image::new((picture.id(), size)).corner_radius(10);
    let pressed = ui.add(image.sense(egui::Sense::click())).clicked();
    let length = text_size(ui, title, 18.0).x;
    let room = CARD - 16.0;
    let size = if length > room { 18.0 * room / length } else { 18.0 };
    scan.button(ui, true, large(title, size, CARD).selected(shown)) || pressed
}

/// The picture of an exhibit on the card, sent once.
fn texture(ctx: &egui::Context, exhibit: &Exhibit) -> TextureHandle {
    let id = Id::unique(("exhibit", &exhibit.name));
    if let Some(texture) = ctx.data(|data| data.get_temp::<TextureHandle>(id)) {
        return texture;
    }
    let picture = &exhibit.picture;
    let image = ColorImage::from_rgb([picture.width, picture.height], picture.rgb.as_flattened());
    let texture = ctx.load_texture(&exhibit.name, image, TextureOptions::LINEAR);
    ctx.data_mut(|data| data.insert_temp(id, texture.clone()));
    texture
}

/// Shows the task, how near the work is, and the time left.
pub(super) fn task(
    ctx: &egui::Context,
    free: egui::Rect,
    words: &Language,
    (screen, now): (&Screen, &View),
    pad: &mut KioskPad,
    scan: &mut Scan,
) {
    let Some(exhibit) = now.exhibit.and_then(|i| screen.exhibits.get(i)) else { return };
    let Some(step) = exhibit.steps.get(now.step) else { return };
    let score = screen.desk.score.lock().ok().and_then(|score| *score);
    place(ctx, "figures", free, Align2::RIGHT_CENTER, |ui| {
        ui.set_width(FIGURES);
        ui.label(RichText::new(exhibit.manifest.title.get(&words.code)).size(24.0).strong());
        ui.label(RichText::new(step.text.get(&words.code)).size(18.0));
        if let Some(score) = score.filter(|_| step.goal.is_some()) {
            ui.add_space(8.0);
            let percent = score.percent();
            ui.label(RichText::new(near(words, percent)).size(24.0));
            let bar = egui::ProgressBar::new(score.done as f32).desired_height(12.0);
            ui.add(bar);
            differences(ui, words, &score);
        }
        if let Some(left) = now.visit_left_s {
            ui.add_space(8.0);
            let time = format!("{}:{:02}", left / 60, left % 60);
            ui.label(RichText::new(words.time_left.replace("{time}", &time)).size(18.0));
        }
        // From a chair nobody reaches so high.
        if !screen.show.seated {
            ui.add_space(8.0);
            choices(ui, words, (screen, now), pad, scan);
        }
    });
}

fn near(words: &Language, percent: u32) -> String {
    words.near.replace("{percent}", &percent.to_string())
}

/// How much too much and too little there is, in the colours of the map.
fn differences(ui: &mut egui::Ui, words: &Language, score: &Score) {
    for (text, length, end) in
        [(&words.too_much, score.too_much, 1.0), (&words.too_little, score.too_little, -1.0)]
    {
        ui.horizontal(|ui| {
            let (dot, _) = ui.allocate_exact_size(vec2(14.0, 14.0), egui::Sense::hover());
            let [r, g, b] = Map::Distance.colour(end, -1.0, 1.0);
            ui.painter().circle_filled(dot.center(), 7.0, Color32::from_rgb(r, g, b));
            let text = text.replace("{length}", &words.decimal(length));
            ui.label(RichText::new(text).size(18.0));
        });
    }
}

/// Shows or hides the goal and the difference, and goes on to the next step.
pub(super) fn choices(
    ui: &mut egui::Ui,
    words: &Language,
    (screen, now): (&Screen, &View),
    pad: &mut KioskPad,
    scan: &mut Scan,
) {
    let Some(step) = step_of(screen, now) else { return };
    let steps = now.exhibit.and_then(|i| screen.exhibits.get(i)).map_or(0, |e| e.steps.len());
    let touched = || screen.desk.touched.store(true, Relaxed);
    if step.goal.is_none() && now.step + 1 >= steps {
        return;
    }
    let layout = match screen.show.seated {
        true => egui::Layout::left_to_right(egui::Align::Center),
        false => egui::Layout::top_down(egui::Align::Center),
    };
    ui.with_layout(layout, |ui| {
        ui.style_mut().wrap_mode = Some(egui::TextWrapMode::Extend);
        let width = if screen.show.seated { 160.0 } else { FIGURES };
        let large = |text: &str| large(text, 20.0, width);
        if step.goal.is_some() {
            let ghost = pad.ghost.unwrap_or(step.ghost) && !pad.compares;
            if scan.button(ui, true, large(&words.goal).selected(ghost)) {
                (pad.ghost, pad.compares) = (Some(!ghost), false);
                touched();
            }
            let compare = large(&words.compare).selected(pad.compares);
            if scan.button(ui, true, compare) {
                pad.compares = !pad.compares;
                touched();
            }
        }
        if now.step + 1 < steps && scan.button(ui, true, large(&words.next)) {
            screen.desk.next_step.store(true, Relaxed);
            touched();
        }
    });
}

/// Shows the score of the last work.
pub(super) fn result(ui: &mut egui::Ui, words: &Language, result: &VisitResult) {
    let percent = result.score.percent().to_string();
    let text = words.result.replace("{percent}", &percent);
    ui.add(egui::Label::new(RichText::new(text).size(26.0)).extend());
    ui.add_space(10.0);
}
