//! Every screen of an installation in every language and at four sizes: no text is cut or covers
//! another one, and each has a contrast of at least 7:1. `SCULPTD_SCREENS=FOLDER` writes pictures.

use std::sync::atomic::Ordering::Relaxed;

use egui::epaint::{Primitive, Shape, TextShape};
use egui::{Color32, Pos2, Rect};
use egui_kittest::Harness;
use sculptd_daemon::kiosk::desk::{Screen, VisitResult};
use sculptd_daemon::kiosk::exhibit::score::Score;
use sculptd_daemon::kiosk::staff::StaffFacts;
use sculptd_daemon::kiosk::{Hint, NextOpening, Stage, View};
use sculptd_daemon::qr_code::{Code, Invitation};

use super::kiosk::{exhibits, harness, screen};
use super::panels::State;

/// Width and height in points, pixels a point, as the window sets them for its pixels, and the size
/// of the text: on the small screen larger than there is room for.
const SIZES: [([f32; 2], f32, f32); 4] = [
    ([1080.0, 1920.0], 1.0, 1.0),
    ([1920.0, 1080.0], 1.0, 1.0),
    ([1920.0, 1080.0], 2.0, 1.0),
    ([1280.0, 720.0], 1.0, 1.5),
];
/// WCAG 2, enhanced.
const CONTRAST: f32 = 7.0;
/// The middle of the clay's ground, where no panel lies.
const GROUND: Color32 = Color32::from_rgb(40, 41, 45);

/// A screen: its name, and what puts it in place.
type Case = (&'static str, fn(&mut Screen, &mut State));

fn show(screen: &Screen, view: View) {
    *screen.desk.view.lock().expect("a desk") = Some(view);
}

fn stage(stage: Stage) -> View {
    View { stage, seconds_left: 15, ..View::default() }
}

fn score() -> Score {
    Score { near: 0.9, off: 0.5, done: 0.876, too_much: 12.34, too_little: 3.21 }
}

fn visit(screen: &mut Screen, exhibit: usize) {
    screen.exhibits = exhibits();
    *screen.desk.score.lock().expect("a desk") = Some(score());
    let view = View { exhibit: Some(exhibit), visit_left_s: Some(125), ..stage(Stage::Working) };
    show(screen, view);
}

fn code(text: &str) -> (String, Code) {
    (text.to_owned(), Code::of(text).expect("a code"))
}

const CASES: [Case; 15] = [
    ("attract", |screen, _| {
        let (url, code) = code("http://192.168.100.200:8710/#0123456789abcdef0123456789abcdef");
        screen.watch = Some(Invitation { url, code });
        show(screen, View { work: Some(123), ..stage(Stage::Attract) });
    }),
    ("attract-one", |screen, _| {
        screen.exhibits = exhibits();
        screen.exhibits.truncate(1);
        show(screen, stage(Stage::Attract));
    }),
    ("choice", |screen, _| {
        screen.exhibits = exhibits();
        let result = VisitResult { exhibit: 1, score: score() };
        *screen.desk.result.lock().expect("a desk") = Some(result);
        show(screen, View { work: Some(123), ..stage(Stage::Attract) });
    }),
    ("working", |screen, state| {
        state.published.undo_steps = 0;
        show(screen, stage(Stage::Working));
    }),
    ("figurine", |screen, _| visit(screen, 0)),
    ("pot", |screen, _| visit(screen, 1)),
    ("relief", |screen, _| visit(screen, 2)),
    ("countdown", |screen, _| show(screen, stage(Stage::Countdown))),
    ("consent", |screen, _| {
        screen.exhibits = exhibits();
        let result = VisitResult { exhibit: 0, score: score() };
        *screen.desk.result.lock().expect("a desk") = Some(result);
        screen.desk.asks_consent.store(true, Relaxed);
        screen.desk.kept.store(true, Relaxed);
        show(screen, stage(Stage::Farewell));
    }),
    ("code", |screen, _| {
        #[cfg(unix)]
        {
            let (url, code) = code("http://192.168.100.200:65535/0123456789abcdef0123456789abcdef");
            let link = sculptd_daemon::kiosk::share::Link { url, code, until_us: u64::MAX };
            *screen.desk.link.lock().expect("a desk") = Some(link);
        }
        show(screen, stage(Stage::Farewell));
    }),
    ("closed", |screen, _| {
        let opens_next = Some(NextOpening { weekday: Some(2), minute: 605 });
        show(screen, View { opens_next, dim_percent: 60, ..stage(Stage::Closed) });
    }),
    ("cleaning", |screen, _| show(screen, View { cleaning: true, ..stage(Stage::Closed) })),
    ("keypad", |screen, state| {
        state.ui_state.pad.typed = Some("47".into());
        show(screen, View { wrong: 1, ..stage(Stage::Attract) });
    }),
    ("locked", |screen, state| {
        state.ui_state.pad.typed = Some(String::new());
        show(screen, View { wrong: 3, locked: true, ..stage(Stage::Attract) });
    }),
    ("staff", |screen, state| {
        screen.exhibits = exhibits();
        state.devices = vec!["Wacom Intuos Pro M: connected, 200 reports a second".into()];
        *screen.desk.staff.lock().expect("a desk") = StaffFacts {
            visits_today: 12,
            visits: 34,
            kept_today: 7,
            mean_s: 83,
            up_s: 7260,
            errors: vec!["/home/visitor/gallery: no space left on device (28)".into()],
            free_bytes: Some(12_345_678_901),
            celsius: Some(61.0),
            cleaning: false,
            exported: Some(Ok("/home/visitor/gallery/work-000002-to-000007.zip".into())),
        };
        show(screen, View { staff: true, exhibit: Some(0), ..stage(Stage::Working) });
    }),
];

/// A text on the screen, and the colours around it.
struct DrawnText {
    text: String,
    rect: Rect,
    clip: Rect,
    elided: bool,
    colours: Vec<Color32>,
    ground: Color32,
}

/// Lays a colour over another one.
fn over(top: Color32, below: Color32) -> Color32 {
    let rest = 1.0 - f32::from(top.a()) / 255.0;
    let mix = |t: u8, b: u8| (f32::from(t) + f32::from(b) * rest).round().min(255.0) as u8;
    Color32::from_rgb(mix(top.r(), below.r()), mix(top.g(), below.g()), mix(top.b(), below.b()))
}

fn luminance(colour: Color32) -> f32 {
    let linear = |v: u8| {
        let v = f32::from(v) / 255.0;
        if v <= 0.040_45 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) }
    };
    0.2126 * linear(colour.r()) + 0.7152 * linear(colour.g()) + 0.0722 * linear(colour.b())
}

fn contrast(a: Color32, b: Color32) -> f32 {
    let (a, b) = (luminance(a), luminance(b));
    (a.max(b) + 0.05) / (a.min(b) + 0.05)
}

/// Adds a shape and what is in it: fills in the order in which they are drawn, and texts.
fn collect(shape: &Shape, clip: Rect, fills: &mut Vec<(Rect, Color32)>, out: &mut Vec<DrawnText>) {
    match shape {
        Shape::Vec(all) => all.iter().for_each(|shape| collect(shape, clip, fills, out)),
        Shape::Rect(rect) if rect.fill.a() > 0 && rect.blur_width == 0.0 => {
            fills.push((rect.rect.intersect(clip), rect.fill));
        }
        Shape::Text(text) if !text.galley.text().trim().is_empty() => {
            let rect = text.visual_bounding_rect();
            let below = fills.iter().filter(|(fill, _)| fill.contains(rect.center()));
            let ground = below.fold(GROUND, |ground, (_, fill)| over(*fill, ground));
            out.push(DrawnText {
                text: text.galley.text().to_owned(),
                rect,
                clip,
                elided: text.galley.elided,
                colours: colours(text).into_iter().map(|c| over(c, ground)).collect(),
                ground,
            });
        }
        _ => {}
    }
}

fn colours(text: &TextShape) -> Vec<Color32> {
    let of = |colour: Color32| {
        let colour = text.override_text_color.unwrap_or(colour);
        let colour = if colour == Color32::PLACEHOLDER { text.fallback_color } else { colour };
        colour.gamma_multiply(text.opacity_factor)
    };
    text.galley.job.sections.iter().map(|section| of(section.format.color)).collect()
}

fn texts(h: &Harness<'_, State>) -> Vec<DrawnText> {
    let (mut fills, mut all) = (Vec::new(), Vec::new());
    for clipped in &h.output().shapes {
        collect(&clipped.shape, clipped.clip_rect, &mut fills, &mut all);
    }
    all
}

/// Returns what is wrong with the texts of a screen. `disabled`: texts of buttons that cannot be
/// pressed now, which may be pale.
fn faults(all: &[DrawnText], size: [f32; 2], disabled: &[&str]) -> Vec<String> {
    let inside = Rect::from_min_size(Pos2::ZERO, size.into());
    let mut faults = Vec::new();
    for (i, one) in all.iter().enumerate() {
        let (text, rect) = (&one.text, one.rect);
        if one.elided || !inside.contains_rect(rect) || !one.clip.expand(1.0).contains_rect(rect) {
            faults.push(format!("\"{text}\" {rect:?} is cut"));
        }
        for other in &all[..i] {
            if rect.shrink(1.0).intersects(other.rect) {
                faults.push(format!("\"{text}\" {rect:?} lies over \"{}\"", other.text));
            }
        }
        for colour in &one.colours {
            let found = contrast(*colour, one.ground);
            if found < CONTRAST && !disabled.contains(&text.as_str()) {
                let ground = one.ground;
                faults.push(format!("\"{text}\" {colour:?} on {ground:?}: {found:.1}:1"));
            }
        }
    }
    faults
}

/// Draws what the panels show, without pictures.
fn picture(h: &Harness<'_, State>, size: [f32; 2]) -> image::RgbImage {
    let (width, height) = (size[0] as u32, size[1] as u32);
    let ground = [GROUND.r(), GROUND.g(), GROUND.b()];
    let mut out = image::RgbImage::from_pixel(width, height, image::Rgb(ground));
    let atlas = h.ctx.fonts(|fonts| fonts.image());
    let output = h.output();
    let scale = output.pixels_per_point;
    for part in h.ctx.tessellate(output.shapes.clone(), scale) {
        let Primitive::Mesh(mut mesh) = part.primitive else { continue };
        mesh.vertices.iter_mut().for_each(|v| v.pos = (v.pos.to_vec2() * scale).to_pos2());
        let clip = part.clip_rect * scale;
        let font = mesh.texture_id == egui::TextureId::default();
        for corner in mesh.indices.chunks(3) {
            let [a, b, c] = [0, 1, 2].map(|i| mesh.vertices[corner[i] as usize]);
            let area =
                (b.pos - a.pos).x * (c.pos - a.pos).y - (b.pos - a.pos).y * (c.pos - a.pos).x;
            if area == 0.0 {
                continue;
            }
            let bounds = Rect::from_points(&[a.pos, b.pos, c.pos]).intersect(clip);
            let columns =
                bounds.min.x.max(0.0) as u32..(bounds.max.x.ceil().max(0.0) as u32).min(width);
            for y in bounds.min.y.max(0.0) as u32..(bounds.max.y.ceil().max(0.0) as u32).min(height)
            {
                for x in columns.clone() {
                    let p = Pos2::new(x as f32 + 0.5, y as f32 + 0.5);
                    let side = |from: Pos2, to: Pos2| {
                        ((to - from).x * (p - from).y - (to - from).y * (p - from).x) / area
                    };
                    let w = [side(b.pos, c.pos), side(c.pos, a.pos), side(a.pos, b.pos)];
                    if w.iter().any(|w| *w < 0.0) {
                        continue;
                    }
                    let mix = |of: &dyn Fn(&egui::epaint::Vertex) -> f32| {
                        of(&a) * w[0] + of(&b) * w[1] + of(&c) * w[2]
                    };
                    let uv = [mix(&|v| v.uv.x), mix(&|v| v.uv.y)];
                    let at =
                        |i: usize| ((uv[i] * atlas.size[i] as f32) as usize).min(atlas.size[i] - 1);
                    let texel = if font { atlas[(at(0), at(1))] } else { Color32::GRAY };
                    let channel = |i: usize| {
                        mix(&|v| f32::from(v.color.to_array()[i])) * f32::from(texel.to_array()[i])
                            / 255.0
                    };
                    let rest = 1.0 - channel(3) / 255.0;
                    let pixel = out.get_pixel_mut(x, y);
                    for i in 0..3 {
                        pixel.0[i] = (channel(i) + f32::from(pixel.0[i]) * rest).min(255.0) as u8;
                    }
                }
            }
        }
    }
    out
}

#[test]
fn every_screen_in_every_language_at_four_sizes_has_whole_clear_texts() {
    let folder = std::env::var_os("SCULPTD_SCREENS").map(std::path::PathBuf::from);
    let mut wrong = Vec::new();
    let mut looked = 0;
    for (size, scale, text) in SIZES {
        for (name, set) in CASES {
            let mut screen = screen();
            screen.show.text = text;
            screen.show.hints = vec![Hint::Pen, Hint::Touch, Hint::OneHand, Hint::TwoHands];
            // The harness has a copy of the screen: it is made after the case is set.
            let mut first = super::panels::state(sculptd_window::panels::Tab::Look);
            set(&mut screen, &mut first);
            let mut h = harness(&screen, size);
            // The size is in points, and a new scale changes it once.
            h.set_pixels_per_point(scale);
            h.run_steps(1);
            let zoom = h.ctx.pixels_per_point() / scale;
            let size = size.map(|side| side / zoom);
            h.set_size(size.into());
            std::mem::swap(&mut h.state_mut().published, &mut first.published);
            h.state_mut().devices = first.devices;
            h.state_mut().ui_state.pad.typed = first.ui_state.pad.typed;
            // In a short run the longest words, and letters without spaces.
            let asked = |code: &str| crate::field::long() || ["de", "ja"].contains(&code);
            for (i, words) in screen.words.iter().enumerate().filter(|w| asked(&w.1.code)) {
                h.state_mut().ui_state.pad.language = i;
                h.run_steps(4);
                let all = texts(&h);
                assert!(!all.is_empty(), "{name}");
                looked += all.len();
                let mut disabled = vec![words.undo.as_str(), screen.words[0].undo.as_str()];
                if name == "locked" {
                    disabled.extend(["0", "1", "2", "3", "4", "5", "6", "7", "8", "9", "OK"]);
                }
                let found = faults(&all, size, &disabled);
                let pixels = size.map(|side| (side * scale * zoom).round());
                let at = format!("{name}-{}-{}x{}", words.code, pixels[0], pixels[1]);
                wrong.extend(found.into_iter().map(|fault| format!("{at}: {fault}")));
                let drawn = ["de", "el", "en", "ja"].contains(&words.code.as_str());
                if let Some(folder) = folder.as_ref().filter(|_| drawn) {
                    let file = folder.join(format!("{at}.png"));
                    picture(&h, pixels).save(file).expect("written");
                }
            }
        }
    }
    println!("{looked} texts");
    wrong.dedup();
    assert!(wrong.is_empty(), "{} faults:\n{}", wrong.len(), wrong.join("\n"));
}
