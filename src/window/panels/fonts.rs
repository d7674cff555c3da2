//! Fonts for languages whose letters egui's own fonts lack: the program brings none along and looks
//! for one among those of the system.

use egui::{FontData, FontFamily, FontId};

use super::icons;
use super::state::UiState;
use crate::language::{self, Translation, Translations};

/// Families that are taken before others, by language: Japanese and Chinese write the same
/// characters in different forms.
const PREFERRED: [(&str, &[&str]); 2] = [
    (
        "ja",
        &[
            "Noto Sans CJK JP",
            "Noto Sans JP",
            "Source Han Sans JP",
            "Hiragino Sans",
            "Yu Gothic UI",
            "IPAexGothic",
            "VL Gothic",
        ],
    ),
    (
        "zh",
        &[
            "Noto Sans CJK SC",
            "Noto Sans SC",
            "Source Han Sans SC",
            "PingFang SC",
            "Microsoft YaHei UI",
            "WenQuanYi Micro Hei",
            "WenQuanYi Zen Hei",
        ],
    ),
];

/// From here on Unicode has the characters of Chinese and Japanese.
const IDEOGRAPHS: char = '\u{2e80}';

/// Makes this thread speak the language that the preferences ask for, with a font that has its
/// letters; English where the system has none.
pub fn speak(ctx: &egui::Context, translations: &Translations, ui_state: &mut UiState) {
    let wanted = translations.choose(&ui_state.prefs.language);
    let shown = &mut ui_state.shown_language;
    if shown.chosen.as_deref() != Some(wanted.code()) {
        shown.chosen = Some(wanted.code().to_owned());
        shown.fontless = !prepare(ctx, wanted);
    }
    language::set_current(if shown.fontless { translations.english() } else { wanted });
}

/// Gives the context what it needs to draw a language; `false`: there is no such font.
fn prepare(ctx: &egui::Context, translation: &Translation) -> bool {
    let letters = translation.letters();
    // The font of another such language may be in use, and has other forms of the same characters.
    let lacking = match PREFERRED.iter().any(|p| p.0 == translation.code()) {
        true => letters.chars().filter(|c| *c >= IDEOGRAPHS).collect(),
        false => missing(ctx, letters),
    };
    if lacking.is_empty() {
        ctx.set_fonts(icons::fonts());
        return true;
    }
    let Some(font) = system_font(translation.code(), &lacking) else {
        ctx.set_fonts(icons::fonts());
        return false;
    };
    let mut fonts = icons::fonts();
    let name = translation.code().to_owned();
    fonts.font_data.insert(name.clone(), font.into());
    for family in [FontFamily::Proportional, FontFamily::Monospace] {
        fonts.families.entry(family).or_default().push(name.clone());
    }
    ctx.set_fonts(fonts);
    true
}

/// Loads fonts of the system for languages whose own names the fonts in use cannot draw.
pub fn load_for<'a>(
    ctx: &egui::Context,
    translations: &Translations,
    names: impl Iterator<Item = &'a str>,
) {
    let all = translations.all();
    for name in names.filter(|name| !can_draw(ctx, name)) {
        if let Some(translation) = all.iter().find(|t| t.names().0 == name) {
            prepare(ctx, translation);
        }
    }
}

/// Returns true if the fonts in use have every letter of a text.
pub fn can_draw(ctx: &egui::Context, text: &str) -> bool {
    ctx.fonts_mut(|f| f.has_glyphs(&FontId::proportional(14.0), text))
}

/// The letters that the fonts in use lack.
fn missing(ctx: &egui::Context, letters: &str) -> Vec<char> {
    let mut buffer = [0; 4];
    letters.chars().filter(|c| !can_draw(ctx, c.encode_utf8(&mut buffer))).collect()
}

/// A font of the system that has all of these letters.
fn system_font(code: &str, letters: &[char]) -> Option<FontData> {
    let mut fonts = fontdb::Database::new();
    fonts.load_system_fonts();
    let preferred = PREFERRED.iter().find(|p| p.0 == code).map_or(&[][..], |p| p.1);
    let rank = |face: &fontdb::FaceInfo| {
        let named = |name: &&str| face.families.iter().any(|(family, _)| family == *name);
        let place = preferred.iter().position(named).unwrap_or(preferred.len());
        let weight = face.weight.0.abs_diff(fontdb::Weight::NORMAL.0);
        let name = face.families.first().map_or_else(String::new, |(family, _)| family.clone());
        (place, weight, face.style != fontdb::Style::Normal, face.monospaced, name)
    };
    let mut faces: Vec<&fontdb::FaceInfo> = fonts.faces().collect();
    faces.sort_by_cached_key(|face| rank(face));
    let has_all = |data: &[u8], index: u32| {
        ttf_parser::Face::parse(data, index)
            .is_ok_and(|face| letters.iter().all(|c| face.glyph_index(*c).is_some()))
    };
    let id = faces.iter().find(|f| fonts.with_face_data(f.id, has_all) == Some(true))?.id;
    fonts
        .with_face_data(id, |data, index| FontData { index, ..FontData::from_owned(data.to_vec()) })
}
