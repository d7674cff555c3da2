//! `sculptd config check|show|schema`.

use std::path::PathBuf;

use serde_json::{Value, json};

use super::{Fail, Outcome, answer};
use crate::settings;
use sculptd_daemon::config::{ConfigError, Resolved, usual_files};

#[derive(Debug, clap::Subcommand)]
pub enum ConfigCommand {
    /// Say whether a file, or the usual ones, can be used.
    Check { file: Option<PathBuf> },
    /// Every value in force and where it was written.
    Show {
        /// Lay this file over the usual ones.
        #[arg(long, value_name = "FILE")]
        config: Option<PathBuf>,
    },
    /// Every key with its default and its meaning.
    Schema,
}

fn load(file: Option<&PathBuf>) -> Result<Resolved, Fail> {
    Resolved::load(file.map(|f| f.as_path()), crate::presets())
        .map_err(|e: ConfigError| Fail::Config(e.to_string()))
}

/// Numbers as a person would write them: a setting of 0.3 is kept in 32 bits, and is no
/// 0.30000001192092896 to anybody.
pub fn plain_numbers(value: &mut Value) {
    match value {
        Value::Number(n) => {
            let Some(wide) = n.as_f64().filter(|_| n.is_f64()) else { return };
            let narrow = wide as f32;
            if f64::from(narrow) == wide
                && let Some(short) =
                    narrow.to_string().parse().ok().and_then(serde_json::Number::from_f64)
            {
                *n = short;
            }
        }
        Value::Array(all) => all.iter_mut().for_each(plain_numbers),
        Value::Object(all) => all.values_mut().for_each(plain_numbers),
        _ => {}
    }
}

pub fn run(command: &ConfigCommand, as_json: bool) -> Outcome {
    match command {
        ConfigCommand::Check { file } => {
            load(file.as_ref())?;
            let files: Vec<PathBuf> =
                usual_files().into_iter().filter(|p| p.is_file()).chain(file.clone()).collect();
            answer(as_json, &json!({ "good": true, "files": files }), |out| {
                writeln!(out, "good: {} file(s) read", files.len())?;
                files.iter().try_for_each(|f| writeln!(out, "  {}", f.display()))
            });
        }
        ConfigCommand::Show { config } => {
            let resolved = load(config.as_ref())?;
            let mut all =
                serde_json::to_value(&resolved.config).map_err(|e| Fail::Config(e.to_string()))?;
            plain_numbers(&mut all);
            let mut rows = Vec::new();
            if let Value::Object(sections) = &all {
                for (section, keys) in sections {
                    for (key, value) in keys.as_object().into_iter().flatten() {
                        let name = format!("{section}.{key}");
                        let origin = resolved
                            .origins
                            .get(&name)
                            .cloned()
                            .unwrap_or_else(|| "default".into());
                        rows.push((name, value.clone(), origin));
                    }
                }
            }
            let object: serde_json::Map<String, Value> = rows
                .iter()
                .map(|(n, v, o)| (n.clone(), json!({ "value": v, "origin": o })))
                .collect();
            answer(as_json, &object, |out| {
                rows.iter().try_for_each(|(n, v, o)| {
                    writeln!(out, "{n:<28} {v:<40} {o}", v = v.to_string())
                })
            });
        }
        ConfigCommand::Schema => {
            answer(as_json, &json!({ "toml": settings::DAEMON }), |out| {
                out.write_all(settings::DAEMON.as_bytes())
            });
        }
    }
    Ok(())
}
