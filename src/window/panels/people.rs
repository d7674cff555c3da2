//! Who shares the sculpture: a list, and the names beside their rings and hands over the clay.

use egui::{Align2, Color32, FontId, Rect, pos2, vec2};
use glam::Vec3;

use super::qr_code;
use super::rows;
use super::state::View;
use super::theme;
use crate::language::tr;
use sculptd_daemon::Published;
use sculptd_daemon::people::{PeopleHere, Person, PersonRole, SharedState, colour_of};

/// Batches of the own input on their way beyond which their number is shown: half a second's.
const MANY_WAITING: u64 = 60;

fn colour(number: u8) -> Color32 {
    let [r, g, b] = colour_of(number);
    Color32::from_rgb(r, g, b)
}

/// The list: those who are here, then those who have gone, then the code by which guests join.
/// Nothing where nobody can join.
pub fn ui(ui: &mut egui::Ui, view: &View<'_>) {
    if view.state.people.is_none() && view.invitation.is_none() {
        return;
    }
    ui.add_space(8.0);
    ui.strong(tr!("people-heading"));
    if let Some(people) = &view.state.people {
        list(ui, people);
        link(ui, view.state, people);
    }
    if let Some(invitation) = view.invitation {
        egui::CollapsingHeader::new(tr!("people-invite")).id_salt("invitation").show(ui, |ui| {
            ui.label(tr!("people-invite-about"));
            qr_code::ui(ui, &invitation.code, 190.0);
            ui.add(egui::Label::new(egui::RichText::new(&invitation.url).small()).wrap());
            if ui.button(tr!("people-invite-copy")).clicked() {
                ui.copy_text(invitation.url.clone());
            }
        });
    }
}

fn list(ui: &mut egui::Ui, people: &PeopleHere) {
    for person in people.all.iter().filter(|p| p.here) {
        row(ui, person, people);
    }
    let gone: Vec<&str> = people.all.iter().filter(|p| !p.here).map(|p| &*p.name).collect();
    if !gone.is_empty() {
        ui.colored_label(theme::quiet(ui), tr!("people-gone", names = gone.join(", ")));
    }
}

/// The connection to the others: nothing where nothing is shared.
fn link(ui: &mut egui::Ui, state: &Published, people: &PeopleHere) {
    let standing = state.standing;
    let (seconds, waiting) = (standing.since_s.to_string(), standing.waiting.to_string());
    let (text, is_trouble) = match standing.state {
        SharedState::NotShared => return,
        SharedState::Hosts => (tr!("people-hosts"), false),
        SharedState::Follows if standing.waiting > MANY_WAITING => {
            (tr!("people-waiting", waiting = waiting), false)
        }
        SharedState::Follows => (tr!("people-follows", host = people.name(standing.host)), false),
        SharedState::CutOff => (tr!("people-cut-off", seconds = seconds, waiting = waiting), true),
        SharedState::SentAway => {
            let reason = people.sent_away.as_deref().unwrap_or_default();
            (tr!("people-sent-away", reason = reason), true)
        }
    };
    let colour = if is_trouble { theme::alarm(ui) } else { theme::quiet(ui) };
    ui.add(egui::Label::new(egui::RichText::new(text).color(colour)).wrap());
    for which in &people.others {
        let text = tr!("people-other", which = &**which);
        ui.add(egui::Label::new(egui::RichText::new(text).color(theme::alarm(ui))).wrap());
    }
}

fn row(ui: &mut egui::Ui, person: &Person, people: &PeopleHere) {
    let role = tr!(match person.role {
        PersonRole::Sculptor => "people-sculptor",
        PersonRole::Viewer => "people-viewer",
        PersonRole::Device => "people-device",
    });
    rows::flow(ui, |ui| {
        let (spot, _) = ui.allocate_exact_size(vec2(12.0, 12.0), egui::Sense::hover());
        ui.painter().circle_filled(spot.center(), 5.0, colour(person.number));
        let own = person.number == people.own;
        let name = if own { tr!("people-you", name = &*person.name) } else { person.name.clone() };
        ui.label(name);
        ui.colored_label(theme::quiet(ui), role);
    });
}

/// Names that are shown over the clay: the place in the world, its person, and whether clay lies
/// before it, as the camera sees it.
pub fn names(state: &Published, camera: &sculptd_engine::camera::Camera) -> Vec<(Vec3, u8, bool)> {
    let hidden = |place: Vec3, spare: f32| {
        let Some(view) = camera.project(place) else { return true };
        let ray = camera.ray(view);
        let far = (place - ray.origin).dot(ray.dir);
        state.pick(ray).is_some_and(|hit| hit.t < far - spare)
    };
    let pens = state.others.iter().flatten();
    let pens = pens.map(|p| (p.position, p.person, hidden(p.position, p.radius.max(1e-6))));
    let hands = state.others_hands().zip(state.hands.as_ref());
    let hands = hands.into_iter().flat_map(|(of, hands)| {
        hands.as_slice().iter().map(move |h| (state.volume.to_world(h.palm), of, false))
    });
    pens.chain(hands).collect()
}

/// The names over the clay. One behind the clay is fainter.
pub fn labels(ctx: &egui::Context, view: &View<'_>, free: Rect) {
    let Some(people) = &view.state.people else { return };
    let layer = egui::LayerId::new(egui::Order::Background, egui::Id::unique("people"));
    let painter = ctx.layer_painter(layer).with_clip_rect(free);
    for (place, number, hidden) in names(view.state, &view.camera) {
        let Some(at) = view.camera.project(place) else { continue };
        let at = free.lerp_inside(vec2(at.x, at.y));
        if !free.contains(at) {
            continue;
        }
        let faint = if hidden { 0.4 } else { 1.0 };
        let font = FontId::proportional(13.0);
        let dark = Color32::from_rgb(16, 16, 20).gamma_multiply(faint);
        let text = painter.layout_no_wrap(people.name(number).into(), font, dark);
        let corner = pos2(at.x + 14.0, at.y - 14.0 - text.size().y);
        let rect = Align2::LEFT_TOP.anchor_size(corner, text.size());
        let ground = colour(number).gamma_multiply(faint);
        painter.rect_filled(rect.expand2(vec2(5.0, 2.0)), 5.0, ground);
        painter.galley(rect.min, text, dark);
    }
}
