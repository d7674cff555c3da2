//! Fonts for languages whose letters egui's own fonts lack: the program brings none along and looks
//! for one among those of the system.

use egui::{FontData, FontDefinitions, FontFamily, FontId};

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

/// Makes this thread speak the language that the preferences ask for, with a font that has its
/// letters; English where the system has none. `offered`: own names of other languages, whose texts
/// are shown too.
pub fn speak(
    ctx: &egui::Context,
    translations: &Translations,
    offered: &[&str],
    ui_state: &mut UiState,
) {
    let wanted = translations.choose(&ui_state.prefs.language);
    let shown = &mut ui_state.shown_language;
    if shown.chosen.as_deref() != Some(wanted.code()) {
        shown.chosen = Some(wanted.code().to_owned());
        let mut fonts = icons::fonts();
        shown.fontless = !add_for(&mut fonts, wanted);
        for other in translations.all().iter().filter(|t| offered.contains(&t.names().0.as_str())) {
            // Without a font that language is not offered.
            add_for(&mut fonts, other);
        }
        ctx.set_fonts(fonts);
    }
    language::set_current(if shown.fontless { translations.english() } else { wanted });
}

/// Adds a font of the system that has the letters of a language which the others lack; `false`:
/// there is none.
fn add_for(fonts: &mut FontDefinitions, translation: &Translation) -> bool {
    let lacking = lacking(fonts, translation.letters());
    if lacking.is_empty() {
        return true;
    }
    let Some(font) = system_font(translation.code(), &lacking) else { return false };
    let name = translation.code().to_owned();
    fonts.font_data.insert(name.clone(), font.into());
    for family in [FontFamily::Proportional, FontFamily::Monospace] {
        fonts.families.entry(family).or_default().push(name.clone());
    }
    true
}

/// Returns true if the fonts in use have every letter of a text.
pub fn can_draw(ctx: &egui::Context, text: &str) -> bool {
    ctx.fonts_mut(|f| f.has_glyphs(&FontId::proportional(14.0), text))
}

/// The letters that none of the fonts for texts has.
fn lacking(fonts: &FontDefinitions, letters: &str) -> Vec<char> {
    let names = fonts.families.get(&FontFamily::Proportional).map_or(&[][..], Vec::as_slice);
    let faces: Vec<_> = names
        .iter()
        .filter_map(|name| fonts.font_data.get(name))
        .filter_map(|data| ttf_parser::Face::parse((*data.font).as_ref(), data.index).ok())
        .collect();
    let has = |c: char| faces.iter().any(|face| face.glyph_index(c).is_some());
    letters.chars().filter(|c| !has(*c)).collect()
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
