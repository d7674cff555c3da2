//! Every known model, and the identification of devices.
//!
//! One pair of ids is often shared by many models (256c:006d by 59). They are distinguished by the
//! data that can be read: report lengths, USB strings, the parameters that some of those strings
//! hold, the report descriptor, names. A contradiction outweighs any agreement: a model whose range
//! of coordinates or pressure differs from the range stated by the device is never chosen, whatever
//! the name. An ambiguous result is reported as such.
//!
//! | module | what it does |
//! |---|---|
//! | `identity` | what can be read of an interface |
//! | `identify` | which model that is |
//! | `params` | the parameter strings of UC-Logic tablets |
//! | `rewritten` | whether a kernel driver replaced the descriptor and changes the reports |
//! | `described` | a tablet built from its report descriptor, if no model is known |
//! | `size` | which stated sizes are believed |

mod described;
mod found;
mod identify;
mod identity;
mod params;
mod rewritten;
mod size;

use std::path::Path;
use std::sync::Arc;

use crate::tablet::{Tablet, TabletError};

pub use found::{Found, Identification};
pub use identity::Identity;
pub use params::Params;

pub(crate) use described::{Scale, by_descriptor};

/// Every known model: the built-in ones and the user's.
#[derive(Debug, Clone, Default)]
pub struct Catalogue {
    tablets: Vec<Arc<Tablet>>,
    /// Number of models that the user added: they come first.
    added: usize,
}

impl Catalogue {
    /// The models that are built into the program.
    ///
    /// # Errors
    /// Never in a release: a test holds every built-in file to its format.
    pub fn builtin() -> Result<Catalogue, TabletError> {
        let mut all = Catalogue::default();
        for (file, text) in crate::builtin::TABLETS {
            all.tablets.push(Arc::new(Tablet::parse(file, text)?));
        }
        Ok(all)
    }

    /// Adds every `.toml` file of a folder. They come before the built-in ones, so that a user's
    /// facts win.
    ///
    /// # Errors
    /// The folder or a file cannot be read, or a file is not valid; the error names it.
    pub fn with_dir(mut self, dir: &Path) -> Result<Catalogue, TabletError> {
        let fail = |what: String| TabletError { file: dir.display().to_string(), what };
        let mut paths: Vec<_> = std::fs::read_dir(dir)
            .and_then(|entries| entries.map(|e| e.map(|e| e.path())).collect::<Result<Vec<_>, _>>())
            .map_err(|e| fail(e.to_string()))?;
        paths.retain(|p| p.extension().is_some_and(|e| e == "toml"));
        paths.sort();
        let mut tablets = Vec::new();
        for path in paths {
            let text = std::fs::read_to_string(&path).map_err(|e| fail(e.to_string()))?;
            tablets.push(Arc::new(Tablet::parse(&path.display().to_string(), &text)?));
        }
        self.added += tablets.len();
        tablets.append(&mut self.tablets);
        Ok(Catalogue { tablets, added: self.added })
    }

    /// The model of this name, if it has an entry for these ids. Used where the user named the
    /// model.
    pub fn named(&self, name: &str, who: &Identity) -> Option<Found> {
        let tablet = self.tablets.iter().find(|t| t.name == name)?;
        let at = tablet.id.iter().position(|id| id.vid == who.vid && id.pid == who.pid)?;
        Some(Found {
            tablet: tablet.clone(),
            at,
            note: Some("as the user said".to_owned()),
            described: false,
            stated_pressure: Params::of(who).map(|p| p.max_pressure),
        })
    }

    /// Returns every model, the user's first.
    pub fn tablets(&self) -> &[Arc<Tablet>] {
        &self.tablets
    }
}
