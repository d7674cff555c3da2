//! The documented settings and the built-in texts: the files of `config/`, embedded. The settings
//! have the same defaults in code; the tests here compare the two.

/// Every setting of the daemon with its default and its meaning (`config/sculptd.toml`).
pub const DAEMON: &str = include_str!("../config/sculptd.toml");
/// Every setting of an installation (`config/kiosk.toml`).
pub const KIOSK: &str = include_str!("../config/kiosk.toml");
/// Rules by which the person at the machine may read pen tablets.
pub const TABLET_RULES: &str = include_str!("../config/70-sculptd.rules");
/// Texts of an installation's screen, by language code.
pub const LANGUAGES: &[(&str, &str)] = &[
    ("en", include_str!("../config/languages/en.toml")),
    ("de", include_str!("../config/languages/de.toml")),
    ("el", include_str!("../config/languages/el.toml")),
    ("es", include_str!("../config/languages/es.toml")),
    ("fr", include_str!("../config/languages/fr.toml")),
    ("it", include_str!("../config/languages/it.toml")),
    ("ja", include_str!("../config/languages/ja.toml")),
    ("zh", include_str!("../config/languages/zh.toml")),
];

macro_rules! window_texts {
    ($($code:literal,)*) => {
        &[$(($code, include_str!(concat!("../config/languages/", $code, "/window.ftl"))),)*]
    };
}

/// Texts of the window, by language code: messages in Fluent's syntax.
pub const WINDOW_TEXTS: &[(&str, &str)] =
    window_texts!["en", "de", "el", "es", "fr", "it", "ja", "zh",];

#[cfg(test)]
mod tests {
    use sculptd_daemon::config::{Config, Resolved};
    use sculptd_daemon::kiosk::KioskConfig;

    use super::*;

    #[test]
    fn the_daemon_s_file_is_the_code_s_own_defaults_and_names_every_key() {
        let written: Config = toml::from_str(DAEMON).expect("it parses");
        // Values missing from the brush's table come from its preset: compared below.
        let code = Config::default();
        assert_eq!(Config { brush: code.brush, ..written }, code);
        let keys = |table: &toml::Table| -> Vec<String> {
            let sections = table.iter();
            let keys = sections.flat_map(|(section, keys)| {
                let keys = keys.as_table().expect("sections").keys();
                keys.map(move |key| format!("{section}.{key}"))
            });
            keys.collect()
        };
        let in_code = toml::Table::try_from(Config::default()).expect("it serialises");
        assert_eq!(keys(&DAEMON.parse().expect("it parses")), keys(&in_code));
        // Applied over the defaults of the code, the file changes nothing but the origins.
        let presets = crate::presets();
        let laid = Resolved::from_text(DAEMON, "the file", presets).expect("it is valid");
        assert_eq!(laid.config, Resolved::defaults(presets).config);
    }

    #[test]
    fn the_kiosk_s_file_is_the_code_s_own_defaults() {
        let written: KioskConfig = toml::from_str(KIOSK).expect("it parses");
        assert_eq!(written, KioskConfig::default());
    }

    #[test]
    fn every_language_has_every_word_and_counts_the_seconds() {
        for (language, _) in LANGUAGES {
            let config = KioskConfig { language: (*language).into(), ..KioskConfig::default() };
            let words = config.words(LANGUAGES).expect("whole");
            assert!(words.countdown.contains("{seconds}"), "{language}");
        }
        assert_eq!(KioskConfig::default().every_language(LANGUAGES).expect("whole").len(), 8);
    }
}
