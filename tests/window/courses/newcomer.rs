//! A newcomer with a mouse: the lesson, the first mistakes, the pages, a file in and out.

use sculptd_geometry::io::write_mesh;
use sculptd_geometry::shapes;
use serde_json::json;

use super::{Course, brush, drag_with, hash, key, press, steps};
use crate::places::{LANGUAGES, MIRROR_X, RADIUS, page};
use crate::stage::{Stage, differs, pause};

#[test]
fn a_newcomer_s_hour_with_a_mouse() {
    let Some(mut c) = Course::begin("newcomer", &[]) else { return };
    c.step("the window opens on a ball, and a hint", |_| {}, |s| s.figure("vertices") > 1_000);
    c.is_as_kept();

    // The lesson, hint by hint.
    c.step("1 of 6: a stroke", |s| s.drag((-60, -30), (60, -30)), |s| steps(s) == 1);
    let camera = |s: &Stage| s.ask("camera", &json!({}));
    let front = camera(&c.s);
    let beside = |s: &mut Stage| drag_with(s, "1", (300, 640), (420, 600));
    c.step("2 of 6: a drag beside the clay turns the view", beside, |s| camera(s) != front);
    let held = |name: &'static str, y: i32| {
        move |s: &mut Stage| {
            s.drive(&["keydown", name]);
            s.drag((-60, y), (60, y));
            s.drive(&["keyup", name]);
        }
    };
    c.step("3 of 6: Shift smooths", held("shift", -30), |s| steps(s) == 2);
    c.step("4 of 6: Ctrl carves", held("ctrl", 50), |s| steps(s) == 3);
    c.step("5 of 6: Ctrl+Z takes back", |s| key(s, "ctrl+z"), |s| steps(s) == 2);
    c.step(
        "6 of 6: the mirror",
        |s| press(s, MIRROR_X),
        |s| brush(s)["symmetry"] == json!([true, false, false]),
    );
    c.step("the lesson is over", |s| s.drag((-60, -90), (60, -80)), |s| steps(s) == 3);
    c.is_as_kept();

    // Help, search, keys.
    let before = c.s.look("course-newcomer-before-help");
    c.step(
        "F1 opens the help",
        |s| key(s, "F1"),
        |s| differs(&before, &s.look("course-newcomer-help")) > 2.0,
    );
    c.step(
        "F1 closes it",
        |s| key(s, "F1"),
        |s| differs(&before, &s.look("course-newcomer-help")) < 2.0,
    );
    c.step(
        "what is called paint is found",
        |s| s.answer("ctrl+k", "paint brush"),
        |s| brush(s)["kind"] == "paint",
    );
    c.step("and draw again", |s| s.answer("ctrl+k", "draw brush"), |s| brush(s)["kind"] == "draw");
    let radius = |s: &Stage| brush(s)["radius"].as_f64().unwrap_or(0.0);
    let was = radius(&c.s);
    c.step(
        "a drag on the slider of the radius",
        |s| drag_with(s, "1", RADIUS, (RADIUS.0 + 20, RADIUS.1)),
        |s| radius(s) > was * 1.1,
    );

    // Every page is opened by its tab and says something.
    let mut last = c.s.look("course-newcomer-look");
    for number in 1..9 {
        let mut now = last.clone();
        c.step(
            &format!("page {} of 9", number + 1),
            |s| press(s, page(number)),
            |s| {
                now = s.look("course-newcomer-page");
                differs(&last, &now) > 0.3
            },
        );
        last = now;
    }
    c.step("and the first again", |s| press(s, page(0)), |_| true);

    // Looks: another material, facets, light panels, larger letters, no panels at all.
    let mut before = c.s.look("course-newcomer-before");
    for (what, keys) in [
        ("another material", "next material"),
        ("every edge", "wireframe"),
        ("light panels", "light or dark"),
        ("larger letters", "larger text"),
    ] {
        let was = before.clone();
        c.step(
            what,
            |s| s.answer("ctrl+k", keys),
            |s| {
                before = s.look("course-newcomer-look");
                differs(&was, &before) > 0.1
            },
        );
    }
    c.is_as_kept();
    c.step("smaller letters again", |s| s.answer("ctrl+k", "smaller text"), |_| true);
    c.step("dark panels again", |s| s.answer("ctrl+k", "light or dark"), |_| true);

    // A mistake, a file in, walls, a file out, another over it.
    let ball = c.s.dir.path().join("small.obj");
    write_mesh(&ball, &shapes::sphere_of_about(5_000).to_poly()).expect("written");
    let (kept, work) = (c.s.figure("vertices"), hash(&c.s));
    c.step(
        "a file that is not there is told, and the work stays",
        |s| {
            s.answer("ctrl+o", "none.obj");
        },
        |s| s.figure("vertices") == kept && hash(s) == work,
    );
    c.step(
        "a mesh is opened",
        |s| s.answer("ctrl+o", "small.obj"),
        |s| s.figure("vertices") != kept,
    );
    c.step("and can be taken back", |s| key(s, "ctrl+z"), |s| s.figure("vertices") == kept);
    c.step("or done again", |s| key(s, "ctrl+shift+z"), |s| s.figure("vertices") != kept);
    let before = c.s.look("course-newcomer-no-walls");
    c.step(
        "T shows how thick the walls are",
        |s| key(s, "t"),
        |s| differs(&before, &s.look("course-newcomer-walls")) > 1.0,
    );
    c.step("T again the clay", |s| key(s, "t"), |_| true);
    let out = c.s.dir.path().join("mine.ply");
    let wanted = out.clone();
    c.step("an export", |s| s.answer("ctrl+e", "mine.ply"), move |_| wanted.exists());
    let first = std::fs::read(&out).expect("a file");
    c.step("a stroke", |s| s.drag((-40, 0), (40, 0)), |s| steps(s) > 0);
    c.step(
        "an export over it asks first",
        |s| s.answer("ctrl+e", "mine.ply"),
        |_| std::fs::read(&out).is_ok_and(|now| now == first),
    );
    c.step(
        "Escape leaves the file as it is",
        |s| key(s, "Escape"),
        |_| std::fs::read(&out).is_ok_and(|now| now == first),
    );

    // A file that is broken, a cut, a part that is hidden; closing and opening again.
    #[allow(clippy::disallowed_methods)] // Nobody reads half of it.
    std::fs::write(c.s.dir.path().join("broken.obj"), "v 0 0 0\nf 1 2 nothing\n").expect("written");
    let (kept, work) = (c.s.figure("vertices"), hash(&c.s));
    let before = c.s.look("course-newcomer-before-broken");
    c.step(
        "a broken file is told, and the work stays",
        |s| s.answer("ctrl+o", "broken.obj"),
        |s| {
            differs(&before, &s.look("course-newcomer-broken")) > 0.05
                && s.figure("vertices") == kept
                && hash(s) == work
        },
    );
    c.step("a box that trims", |s| s.answer("ctrl+k", "trim by a box"), |_| true);
    c.step("what lies in it is cut off", |s| s.drag((-220, -260), (220, -60)), |s| hash(s) != work);
    c.step("and comes back", |s| key(s, "ctrl+z"), |s| hash(s) == work);
    c.step("Escape ends it", |s| key(s, "Escape"), |_| true);
    let all = c.s.look("course-newcomer-all");
    c.step(
        "a box that hides",
        |s| {
            s.answer("ctrl+k", "hide a region");
            key(s, "b");
        },
        |_| true,
    );
    c.step(
        "half of it is hidden",
        |s| s.drag((0, -220), (220, 260)),
        |s| differs(&all, &s.look("course-newcomer-half")) > 1.0,
    );
    c.step(
        "and comes back too",
        |s| {
            key(s, "Escape");
            key(s, "ctrl+z");
        },
        |s| hash(s) == work,
    );
    for (what, keys) in [("from above", "9"), ("from the front", "7"), ("no perspective", "5")] {
        let was = camera(&c.s);
        c.step(what, |s| key(s, keys), |s| camera(s) != was);
        pause(600);
    }
    let was = c.s.look("course-newcomer-no-floor");
    c.step(
        "G shows the floor",
        |s| key(s, "g"),
        |s| differs(&was, &s.look("course-newcomer-floor")) > 0.05,
    );
    let was = c.s.look("course-newcomer-a-page");
    c.step(
        "where the languages are is found",
        |s| s.answer("ctrl+k", "language"),
        |s| differs(&was, &s.look("course-newcomer-languages")) > 0.3,
    );
    preferences(&mut c);
    four_views(&mut c);
    let was = c.s.look("course-newcomer-panels");
    c.step(
        "N takes the panels away",
        |s| key(s, "n"),
        |s| differs(&was, &s.look("course-newcomer-no-panels")) > 2.0,
    );
    c.step(
        "and brings them back",
        |s| key(s, "n"),
        |s| differs(&was, &s.look("course-newcomer-panels-again")) < 1.0,
    );
    assert_eq!(hash(&c.s), work, "nothing has changed the clay since");
    let session =
        crate::sessions::kept(&c.s).pop().expect("a session is always on").display().to_string();
    c.step(
        "the window is closed and the work opened again",
        |s| s.restart(&["--session", &session]),
        |s| hash(s) == work,
    );
    println!("{} steps", c.steps);
}

/// Another language and what else is on the page of preferences; a key of one's own.
fn preferences(c: &mut Course) {
    let file = c.s.dir.path().join("sculptd/viewer.toml");
    let kept = move |text: &str| std::fs::read_to_string(&file).is_ok_and(|t| t.contains(text));
    let was = c.s.look("course-newcomer-english");
    let choose = |y: i32| {
        move |s: &mut Stage| {
            press(s, LANGUAGES);
            pause(1500);
            press(s, (LANGUAGES.0, LANGUAGES.1 + y));
        }
    };
    c.step("Italian", choose(177), |s| {
        kept("language = \"it\"") && differs(&was, &s.look("course-newcomer-italian")) > 0.3
    });
    c.step(
        "its search knows English too",
        |s| s.answer("ctrl+k", "larger text"),
        |_| kept("scale = 1.1"),
    );
    c.step("smaller again", |s| s.answer("ctrl+k", "smaller text"), |_| true);
    c.step("and the page by its Italian name", |s| s.answer("ctrl+k", "lingua"), |_| true);
}

/// The ball from four sides, and back.
fn four_views(c: &mut Course) {
    let parallel = |s: &Stage| s.ask("camera", &json!({}))["orthographic"] == true;
    let go = |s: &Stage, x: &str, y: &str| s.drive(&["mousemove", x, y]);
    let before = c.s.look("course-newcomer-one-view");
    c.step(
        "four views",
        |s| {
            go(s, "834", "203");
            key(s, "4");
        },
        |s| differs(&before, &s.look("course-newcomer-four-views")) > 1.0,
    );
    let at = steps(&c.s);
    c.step(
        "a stroke from above",
        |s| {
            go(s, "437", "179");
            pause(500);
            drag_with(s, "1", (407, 170), (467, 190));
        },
        |s| steps(s) == at + 1 && parallel(s),
    );
    c.step("is taken back", |s| key(s, "ctrl+z"), |s| steps(s) == at);
    c.step(
        "and one again",
        |s| {
            go(s, "834", "203");
            pause(500);
            key(s, "4");
        },
        |s| differs(&before, &s.look("course-newcomer-one-view-again")) < 2.0,
    );
}
