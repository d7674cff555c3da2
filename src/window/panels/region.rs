//! Regions drawn over the view with the pointer: by a lasso, a box, a line, or corner by corner.
//! The faces seen in one are masked, unmasked, hidden, made a face set or cut off, all the way
//! through.
//!
//! While a region can be drawn, the left button draws; the other buttons and the wheel move the
//! view as ever, and pens of tablets may begin no stroke.

use std::sync::Arc;

use egui::{Color32, Event, Id, Key, LayerId, Order, Painter, PointerButton, Pos2, Rect, Sense};
use egui::{Shape, Stroke, vec2};
use glam::Vec2;

use super::rows;
use super::state::region::{RegionDrawing, RegionPurpose, RegionShape, RegionTool};
use super::state::{UiRequest, UiState};
use super::theme;
use crate::language::tr;
use sculptd_clay::face_sets::PartEdit;
use sculptd_daemon::trim::Part;
use sculptd_engine::command::Command;
use sculptd_engine::local_remesh::{LocalRemesh, WantedEdge};
use sculptd_engine::mask_region::MaskRegion;
use sculptd_engine::scene::SceneCommand;
use sculptd_engine::view_region::{MOST_CORNERS, SetsRegion, ViewRegion};

/// Points below which a drag was a slip of the hand.
const SLIP: f32 = 4.0;
/// Points between two places of a lasso, at least.
const STEP: f32 = 2.0;
/// A press so near to the first or the last corner of a polyline, points, closes it.
const CLOSE: f32 = 8.0;

/// The shapes, each with the message of its name.
const SHAPES: [(RegionShape, &str); 4] = [
    (RegionShape::Lasso, "region-lasso"),
    (RegionShape::Box, "region-box"),
    (RegionShape::Line, "region-line"),
    (RegionShape::Polyline, "region-polyline"),
];

/// The purposes, each with the message of its name.
const PURPOSES: [(RegionPurpose, &str); 6] = [
    (RegionPurpose::Mask, "region-mask"),
    (RegionPurpose::Unmask, "region-unmask"),
    (RegionPurpose::Hide, "region-hide"),
    (RegionPurpose::Isolate, "region-isolate"),
    (RegionPurpose::FaceSet, "region-face-set"),
    (RegionPurpose::Remesh, "region-remesh"),
];

/// Returns the layer in which the pointer draws, below everything that floats over the view.
pub fn layer() -> LayerId {
    LayerId::new(Order::Background, Id::unique("region"))
}

/// A button by the message of its name, whose attribute `tip` says what it does.
fn choice(ui: &mut egui::Ui, on: bool, name: &str) -> bool {
    let button = ui.add(egui::Button::selectable(on, tr!(name)));
    button.on_hover_text(tr!(&format!("{name}.tip"))).clicked()
}

/// The buttons that begin a region for a purpose: a panel has them beside what it is about.
pub fn buttons(ui: &mut egui::Ui, tool: &mut RegionTool, purpose: RegionPurpose) {
    rows::flow(ui, |ui| {
        ui.label(tr!("region-draw"));
        for (shape, name) in SHAPES {
            let on = tool.now() == Some((shape, purpose));
            if choice(ui, on, name) {
                match on {
                    true => tool.drawing = None,
                    false => tool.begin(shape, purpose),
                }
            }
        }
    });
}

/// A part of the view from a place in the window; the view fills the free part.
fn share(free: Rect, p: Pos2) -> Vec2 {
    let d = (p - free.min) / free.size();
    Vec2::new(d.x, d.y).clamp(Vec2::ZERO, Vec2::ONE)
}

/// The region that was drawn, the pointer at `to`; `None`: a slip of the hand.
pub fn drawn(drawing: &RegionDrawing, free: Rect, to: Pos2) -> Option<ViewRegion> {
    let from = *drawing.points.first()?;
    let ends = [share(free, from), share(free, to)];
    let way = to - from;
    let bounds = Rect::from_points(&drawing.points);
    match drawing.shape {
        RegionShape::Box => (way.x.abs().min(way.y.abs()) > SLIP).then_some(ViewRegion::Box(ends)),
        RegionShape::Line => (way.length() > SLIP).then_some(ViewRegion::Line(ends)),
        RegionShape::Lasso | RegionShape::Polyline => {
            let corners: Vec<Vec2> = drawing.points.iter().map(|p| share(free, *p)).collect();
            let region = ViewRegion::Polygon(Arc::new(corners));
            (bounds.width().max(bounds.height()) > SLIP && region.is_sane()).then_some(region)
        }
    }
}

/// Builds the request for a drawn region.
pub fn request(purpose: RegionPurpose, region: ViewRegion, tool: &RegionTool) -> UiRequest {
    let front_faces = tool.front_faces;
    let sets = |region, edit| {
        let asked = SetsRegion { region, edit, front_faces };
        UiRequest::World(Command::Scene(SceneCommand::SetsRegion(asked)))
    };
    let mask = |region, mask| {
        UiRequest::World(Command::MaskRegion(MaskRegion { region, mask, front_faces }))
    };
    match (purpose, region) {
        (RegionPurpose::Trim, ViewRegion::Line([a, b])) => {
            UiRequest::Trim(Part::Line([a.x, a.y, b.x, b.y]))
        }
        (RegionPurpose::Trim, ViewRegion::Box([a, b])) => {
            UiRequest::Trim(Part::Box([a.x, a.y, b.x, b.y]))
        }
        // No button and no action begins a trim by another shape.
        (RegionPurpose::Mask | RegionPurpose::Trim, region) => mask(region, 1.0),
        (RegionPurpose::Unmask, region) => mask(region, 0.0),
        (RegionPurpose::Hide, region) => sets(region, PartEdit::Hide),
        (RegionPurpose::Isolate, region) => sets(region, PartEdit::Isolate),
        (RegionPurpose::FaceSet, region) => sets(region, PartEdit::NewSet),
        (RegionPurpose::Remesh, region) => {
            let edge = WantedEdge::OfUsual(tool.edge);
            let asked = LocalRemesh { edge, stretched_only: false, region: Some(region) };
            UiRequest::RemeshLocal(asked)
        }
    }
}

/// The gesture itself, its outline, and a bar that says what is done with it.
/// `free` shows the clay; the region is one of the view in which is worked.
pub fn ui(
    ctx: &egui::Context,
    ui_state: &mut UiState,
    (free, worked_in): (Rect, Rect),
    out: &mut Vec<UiRequest>,
) {
    let tool = &mut ui_state.region;
    let Some(mut drawing) = tool.drawing.take() else { return };
    let typing = ctx.text_edit_focused() || ui_state.search.is_some();
    let pressed = |key| !typing && ctx.input(|i| i.key_pressed(key));
    if pressed(Key::Escape) {
        // The first press discards the drawing, the next one leaves the tool.
        if !drawing.points.is_empty() {
            drawing.points.clear();
            tool.drawing = Some(drawing);
        }
        return;
    }
    if pressed(Key::Backspace) && drawing.shape == RegionShape::Polyline {
        drawing.points.pop();
    }
    let area = egui::Area::new(layer().id).fixed_pos(free.min).order(layer().order);
    let (finished, at) = area
        .show(ctx, |ui| {
            let (_, response) = ui.allocate_exact_size(free.size(), Sense::drag());
            response.widget_info(|| {
                egui::WidgetInfo::labeled(egui::Role::Canvas, true, tr!("region-heading"))
            });
            let clamp = |at: Pos2| at.clamp(worked_in.min, worked_in.max);
            let (mut at, mut moves) = (worked_in.center(), Vec::new());
            ctx.input(|i| {
                at = clamp(i.pointer.latest_pos().unwrap_or(at));
                for event in &i.events {
                    match event {
                        Event::PointerMoved(to) => moves.push(clamp(*to)),
                        // Moves before the press are ignored.
                        Event::PointerButton {
                            button: PointerButton::Primary,
                            pressed,
                            pos,
                            ..
                        } => {
                            if *pressed {
                                moves.clear();
                            } else {
                                at = clamp(*pos);
                            }
                        }
                        _ => {}
                    }
                }
            });
            let pressed_enter = pressed(Key::Enter);
            let finished = follow(&mut drawing, &response, at, &moves) || pressed_enter;
            let painter = ui.painter().clone().with_clip_rect(worked_in);
            outline(&painter, &drawing, at);
            response.on_hover_cursor(egui::CursorIcon::Crosshair);
            (finished, at)
        })
        .inner;
    let mut done = false;
    if finished && !drawing.points.is_empty() {
        let turned = ctx.input(|i| i.modifiers.command || i.modifiers.ctrl);
        let purpose = if turned { drawing.purpose.opposite() } else { drawing.purpose };
        if let Some(region) = drawn(&drawing, worked_in, at) {
            out.push(request(purpose, region, tool));
            done = drawing.purpose == RegionPurpose::Trim;
        }
        drawing.points.clear();
    }
    if drawing.purpose != RegionPurpose::Trim {
        done |= bar(ctx, &mut drawing, tool, free);
    }
    if !done {
        tool.drawing = Some(drawing);
    }
}

/// Takes over what the pointer did since the last frame: where it went (`moves`; a slow frame is
/// several of them late) and where it is. Whether the region is finished.
fn follow(
    drawing: &mut RegionDrawing,
    response: &egui::Response,
    at: Pos2,
    moves: &[Pos2],
) -> bool {
    let down = response.drag_started_by(PointerButton::Primary);
    let up = response.drag_stopped_by(PointerButton::Primary);
    let points = &mut drawing.points;
    if drawing.shape == RegionShape::Polyline {
        let near = |p: Option<&Pos2>| p.is_some_and(|p| p.distance(at) < CLOSE);
        let closes = points.len() > 2 && (near(points.first()) || near(points.last()));
        if down && !closes && points.len() < MOST_CORNERS && !near(points.last()) {
            points.push(at);
        }
        return down && closes;
    }
    if down {
        *points = vec![response.interact_pointer_pos().unwrap_or(at)];
    }
    // Escape has discarded the drawing: the rest of the drag is ignored.
    if points.is_empty() {
        return false;
    }
    for to in moves.iter().filter(|_| drawing.shape == RegionShape::Lasso) {
        if points.last().is_some_and(|last| last.distance(*to) < STEP) {
            continue;
        }
        if points.len() == MOST_CORNERS {
            // Every second place goes.
            let mut keep = false;
            points.retain(|_| {
                keep = !keep;
                keep
            });
        }
        points.push(*to);
    }
    up
}

/// The outline of what was drawn so far, the pointer at `to`.
fn outline(painter: &Painter, drawing: &RegionDrawing, to: Pos2) {
    let Some(&from) = drawing.points.first() else { return };
    let colour = match drawing.purpose {
        RegionPurpose::Trim => Color32::from_rgb(255, 150, 120),
        _ => Color32::from_rgb(255, 214, 120),
    };
    let fill = Color32::from_rgba_unmultiplied(colour.r(), colour.g(), colour.b(), 36);
    let (line, under) =
        (Stroke::new(1.8, colour), Stroke::new(4.0, Color32::from_black_alpha(110)));
    match drawing.shape {
        RegionShape::Box => {
            let rect = Rect::from_two_pos(from, to);
            painter.rect(rect, 0.0, fill, under, egui::StrokeKind::Middle);
            painter.rect_stroke(rect, 0.0, line, egui::StrokeKind::Middle);
        }
        RegionShape::Line => {
            let along = (to - from).normalized();
            // y runs down: to the left as one goes.
            let left = vec2(along.y, -along.x) * 60.0;
            let (a, b) = (from - along * 9000.0, to + along * 9000.0);
            let side = vec![a, b, b + left, a + left];
            painter.add(Shape::convex_polygon(side, fill, Stroke::NONE));
            painter.line_segment([a, b], under);
            painter.line_segment([a, b], line);
        }
        RegionShape::Lasso | RegionShape::Polyline => {
            let mut all = drawing.points.clone();
            all.push(to);
            painter.add(Shape::line(all.clone(), under));
            painter.add(Shape::line(all, line));
            painter.extend(Shape::dashed_line(&[to, from], line, 5.0, 4.0));
            if drawing.shape == RegionShape::Polyline {
                for corner in &drawing.points {
                    painter.circle(*corner, 4.0, colour, Stroke::new(1.0, Color32::BLACK));
                }
            }
        }
    }
}

/// Shows the purpose and the shape of the region. Returns true if drawing ends.
fn bar(
    ctx: &egui::Context,
    drawing: &mut RegionDrawing,
    tool: &mut RegionTool,
    free: Rect,
) -> bool {
    let at = free.center_top() + vec2(0.0, 8.0);
    let area = egui::Area::new(Id::unique("region bar")).pivot(egui::Align2::CENTER_TOP);
    let mut ends = false;
    area.fixed_pos(at).order(Order::Middle).show(ctx, |ui| {
        ui.set_max_width((free.width() - 24.0).clamp(120.0, 520.0));
        egui::Frame::popup(ui.style()).show(ui, |ui| {
            rows::flow(ui, |ui| {
                for (shape, name) in SHAPES {
                    if choice(ui, drawing.shape == shape, name) {
                        (drawing.shape, tool.shape) = (shape, shape);
                        drawing.points.clear();
                    }
                }
                let front = ui.checkbox(&mut tool.front_faces, tr!("region-front"));
                front.on_hover_text(tr!("region-front.tip"));
            });
            rows::flow(ui, |ui| {
                for (purpose, name) in PURPOSES {
                    if choice(ui, drawing.purpose == purpose, name) {
                        (drawing.purpose, tool.purpose) = (purpose, purpose);
                    }
                }
                ends =
                    ui.button(tr!("region-done")).on_hover_text(tr!("region-done.tip")).clicked();
            });
            let how = match drawing.shape {
                RegionShape::Polyline => tr!("region-polyline-note"),
                _ => tr!("region-note"),
            };
            ui.colored_label(theme::quiet(ui), how);
        });
    });
    ends
}
