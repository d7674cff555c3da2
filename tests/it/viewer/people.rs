//! Who shares the sculpture: rings and names in the colours of the people, and the list.

use std::sync::Arc;

use egui_kittest::kittest::Queryable;
use glam::Vec2;
use sculptd_daemon::Published;
use sculptd_daemon::people::{
    PeopleHere, Person, PersonRole, SharedStanding, SharedState, colour_of,
};
use sculptd_devices::{Body, DeviceId, Pen, Sample};
use sculptd_engine::camera::Camera;
use sculptd_engine::command::{Command, OfPerson};
use sculptd_window::look::Look;
use sculptd_window::panels::Tab;
use sculptd_window::panels::people::names;
use sculptd_window::viewer::overlay;
use sculptd_window::viewer::renderer::Scene;

use super::panels::harness;
use super::pictures::painter;

/// As the first of three people sees it: the pen of the second touches before their eyes, that of
/// the third hovers behind the clay.
fn shared() -> Published {
    let mut world = super::world(8_000);
    world.show_to(1);
    let front = *world.camera();
    let behind = Camera { yaw: front.yaw + std::f32::consts::PI, pitch: -front.pitch, ..front };
    let of = |person, command| Command::OfPerson(Box::new(OfPerson { person, command }));
    let views = [of(2, Command::Camera(front)), of(3, Command::Camera(behind))];
    world.step(1, &[], &views);
    let pen = |person: u16, tip: bool, at: Vec2| {
        let (pos_mm, area_mm) = (at * 100.0, Vec2::splat(100.0));
        let pen =
            Pen { in_range: true, tip, pos_mm, area_mm, pressure: Some(1.0), ..Pen::default() };
        let device = DeviceId(person << 8);
        Sample { device, t_us: 0, device_t_us: None, body: Body::Pen(pen) }
    };
    let pens = [
        pen(1, false, Vec2::new(0.45, 0.6)),
        pen(2, true, Vec2::new(0.55, 0.45)),
        pen(3, false, Vec2::splat(0.5)),
    ];
    world.step(2, &pens, &[]);
    let person = |number, name: &str, role, here| Person { number, name: name.into(), role, here };
    let all = vec![
        person(1, "Ada", PersonRole::Sculptor, true),
        person(2, "Bob", PersonRole::Sculptor, true),
        person(3, "Cyd", PersonRole::Sculptor, true),
        person(4, "Wall", PersonRole::Viewer, true),
        person(5, "Eve", PersonRole::Device, false),
    ];
    let mut state = super::published(&mut world);
    state.people = Some(Arc::new(PeopleHere { own: 1, all, ..PeopleHere::default() }));
    state
}

#[test]
fn the_others_have_rings_in_their_colours_and_the_own_is_none_of_them() {
    let state = shared();
    let seen: Vec<u8> = state.others.iter().flatten().map(|p| p.person).collect();
    assert_eq!(seen, [2, 3]);
    let told: Vec<(u8, bool)> = names(&state, &state.camera)
        .into_iter()
        .map(|(_, person, hidden)| (person, hidden))
        .collect();
    assert_eq!(told, [(2, false), (3, true)], "the third is behind the clay");
    let Some(mut painter) = painter() else { return };
    let mut paint = |lines: &[_]| {
        let scene = Scene {
            mesh: &state.mesh,
            camera: &state.camera,
            brush: None,
            lines,
            look: Look::default(),
            values: None,
            beside: Default::default(),
        };
        painter.paint(&scene, 480, 320).expect("a picture")
    };
    let without = paint(&[]);
    // Pixels that a person's ring changes, and how many of them towards the person's colour.
    let mut changed = |person: u8| {
        let mut alone = state.clone();
        alone.others.iter_mut().for_each(|o| *o = o.filter(|p| p.person == person));
        let mut lines = Vec::new();
        overlay::others(&mut lines, &alone);
        assert!(!lines.is_empty());
        let with = paint(&lines);
        let folder = std::env::var_os("SCULPTD_PICTURES").map(std::path::PathBuf::from);
        if let Some(folder) = folder {
            let path = folder.join(format!("people-{person}.png"));
            sculptd_window::viewer::picture::write_png(&path, &with).expect("written");
        }
        let far = |p: &image::Rgba<u8>| {
            let channels = p.0.iter().zip(colour_of(person));
            channels.map(|(a, b)| u32::from(a.abs_diff(b))).sum::<u32>()
        };
        let pixels = without.pixels().zip(with.pixels()).filter(|(a, b)| a != b);
        let towards: Vec<bool> = pixels.map(|(a, b)| far(b) < far(a)).collect();
        (towards.len(), towards.iter().filter(|t| **t).count())
    };
    let (all, towards) = changed(2);
    assert!(all > 60 && towards * 10 > all * 9, "{towards} of {all} pixels take Bob's colour");
    assert_eq!(changed(3), (0, 0), "Cyd's ring lies behind the clay");
}

#[test]
fn the_list_says_who_is_here_as_what_and_who_has_gone() {
    let mut h = harness(Tab::Look);
    assert!(h.query_by_label("People").is_none(), "nobody shares a sculpture of one person");
    h.state_mut().published = shared();
    h.run_steps(3);
    for label in ["People", "Ada (you)", "Bob", "Cyd", "Wall", "viewer", "Gone: Eve"] {
        assert!(h.query_by_label(label).is_some(), "'{label}' is not there");
    }
    assert_eq!(h.query_all_by_label("sculptor").count(), 3);

    // The connection: each state has its own line, and a second sculpture of the name is named.
    let standing =
        |state, waiting| SharedStanding { state, host: 2, since_s: 7, waiting, undelivered: 0 };
    let lines = [
        (SharedState::Hosts, 0, "You host: the others follow this computer"),
        (SharedState::Follows, 0, "Bob hosts"),
        (SharedState::Follows, 90, "90 inputs are on their way"),
        (SharedState::CutOff, 12, "Cut off for 7 s. 12 inputs wait"),
        (SharedState::SentAway, 0, "Sent away: withdrawn. You go on alone"),
    ];
    for (state, waiting, line) in lines {
        let published = &mut h.state_mut().published;
        published.standing = standing(state, waiting);
        let people = published.people.as_ref().expect("shared").as_ref().clone();
        let others = vec!["5f3a90c1 (2 people, since 4 min)".into()];
        let sent_away = Some("withdrawn".into());
        published.people = Some(Arc::new(PeopleHere { others, sent_away, ..people }));
        h.run_steps(2);
        assert!(h.query_by_label(line).is_some(), "'{line}' is not there");
    }
    let other = "Another sculpture of this name: 5f3a90c1 (2 people, since 4 min)";
    assert!(h.query_by_label(other).is_some());
}
