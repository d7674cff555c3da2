//! The gallery of alphas: the built-in ones, the loaded picture, and the pictures in the folder of
//! the person's brushes, each drawn as it is pressed into the clay.

use std::sync::{Arc, Weak};

use egui::{Color32, ColorImage, Id, Sense, TextureHandle, TextureOptions, vec2};

use super::state::{UiRequest, View};
use super::theme;
use crate::language::tr;
use sculptd_clay::brush::{Alpha, BrushSettings, Picture};
use sculptd_engine::command::Command;

/// Sides of a thumbnail: points in the panel, and pixels of its texture.
const SIDE: f32 = 44.0;
const PIXELS: usize = 64;
/// Thumbnails of pictures that are kept at most.
const MOST: usize = 128;

/// The alphas that the program makes, each with the message of its name.
const MADE: [(Alpha, &str); 8] = [
    (Alpha::Studs, "alpha-studs"),
    (Alpha::Scales, "alpha-scales"),
    (Alpha::Rope, "alpha-rope"),
    (Alpha::Stitches, "alpha-stitches"),
    (Alpha::Waves, "alpha-waves"),
    (Alpha::Bricks, "alpha-bricks"),
    (Alpha::Stone, "alpha-stone"),
    (Alpha::Cracks, "alpha-cracks"),
];

/// Content of a thumbnail.
#[derive(Clone)]
struct Thumbnail {
    alpha: Alpha,
    /// Of the alpha `picture`; one that nobody holds any longer is never asked for again.
    picture: Option<Weak<Picture>>,
    texture: TextureHandle,
}

/// The thumbnails that were drawn, kept by the context.
#[derive(Clone, Default)]
struct Thumbnails(Vec<Thumbnail>);

impl Thumbnails {
    fn of(
        &mut self,
        ctx: &egui::Context,
        alpha: Alpha,
        picture: Option<&Arc<Picture>>,
    ) -> egui::TextureId {
        let shows = |t: &Thumbnail| match (&t.picture, picture) {
            (None, None) => t.alpha == alpha,
            (Some(shown), Some(picture)) => std::ptr::eq(shown.as_ptr(), Arc::as_ptr(picture)),
            _ => false,
        };
        if let Some(found) = self.0.iter().find(|t| shows(t)) {
            return found.texture.id();
        }
        self.0.retain(|t| t.picture.as_ref().is_none_or(|p| p.strong_count() > 0));
        self.0.drain(..(self.0.len() + 1).saturating_sub(MOST));
        let image = image(alpha, picture.map(Arc::as_ref));
        let texture = ctx.load_texture(String::new(), image, TextureOptions::LINEAR);
        let id = texture.id();
        self.0.push(Thumbnail { alpha, picture: picture.map(Arc::downgrade), texture });
        id
    }
}

/// An alpha as a grey picture, high places pale; along the stroke it goes to the right.
fn image(alpha: Alpha, picture: Option<&Picture>) -> ColorImage {
    let at = |k: usize| (k as f32 + 0.5) / PIXELS as f32;
    let grey: Vec<u8> = (0..PIXELS * PIXELS)
        .map(|i| alpha.at(at(i % PIXELS), 1.0 - at(i / PIXELS), picture))
        .map(|height| (255.0 * height) as u8)
        .collect();
    ColorImage::from_gray([PIXELS, PIXELS], &grey)
}

/// The gallery; a click takes an alpha in hand, and its picture with it.
pub fn ui(ui: &mut egui::Ui, view: &View<'_>, brush: &mut BrushSettings, out: &mut Vec<UiRequest>) {
    let ctx = ui.ctx().clone();
    let id = Id::unique("alpha thumbnails");
    let mut kept = ctx.data_mut(|d| std::mem::take(d.get_temp_mut_or_default::<Thumbnails>(id)));
    let loaded = view.state.picture.as_ref();
    let in_hand = |p: &Arc<Picture>| loaded.is_some_and(|l| Arc::ptr_eq(l, p) || **l == **p);
    let folder = view.presets.pictures();
    let own = view.presets.own();
    let of_brushes = own.iter().filter_map(|b| b.picture.as_ref().map(|p| (b.name.as_str(), p)));
    let of_files = folder.iter().map(|p| (p.name.as_str(), &p.picture));
    let mut pictures: Vec<(String, &Arc<Picture>)> = Vec::new();
    for (name, picture) in of_brushes.chain(of_files) {
        if !pictures.iter().any(|(_, p)| Arc::ptr_eq(p, picture)) {
            pictures.push((name.to_owned(), picture));
        }
    }
    let shown = brush.alpha == Alpha::Picture;
    // A picture loaded from elsewhere comes first.
    if let Some(loaded) = loaded.filter(|l| !pictures.iter().any(|(_, p)| ***p == ***l)) {
        pictures.insert(0, (tr!("alpha-picture"), loaded));
    }
    ui.label(tr!("stamp-alpha"));
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing = vec2(4.0, 4.0);
        for (alpha, name) in MADE {
            let texture = kept.of(&ctx, alpha, None);
            if thumbnail(ui, texture, &tr!(name), brush.alpha == alpha) {
                brush.alpha = alpha;
            }
        }
        for (name, picture) in &pictures {
            let texture = kept.of(&ctx, Alpha::Picture, Some(picture));
            if thumbnail(ui, texture, name, shown && in_hand(picture)) {
                brush.alpha = Alpha::Picture;
                if !in_hand(picture) {
                    out.push(UiRequest::World(Command::Picture((*picture).clone())));
                }
            }
        }
    });
    ctx.data_mut(|d| d.insert_temp(id, kept));
}

/// One of the gallery; whether it was clicked.
fn thumbnail(ui: &mut egui::Ui, texture: egui::TextureId, name: &str, chosen: bool) -> bool {
    let (rect, response) = ui.allocate_exact_size(vec2(SIDE, SIDE), Sense::click());
    response.widget_info(|| {
        egui::WidgetInfo::selected(egui::Role::RadioButton, ui.is_enabled(), chosen, name)
    });
    let whole = egui::Rect::from_min_max(egui::pos2(0.0, 0.0), egui::pos2(1.0, 1.0));
    ui.painter().image(texture, rect.shrink(2.0), whole, Color32::WHITE);
    let line = match (chosen, response.hovered() || response.has_focus()) {
        (true, _) => egui::Stroke::new(2.0, theme::accent(ui)),
        (false, true) => ui.visuals().widgets.hovered.bg_stroke,
        (false, false) => ui.visuals().widgets.inactive.bg_stroke,
    };
    ui.painter().rect_stroke(rect, 3.0, line, egui::StrokeKind::Inside);
    response.on_hover_text(name).clicked()
}
