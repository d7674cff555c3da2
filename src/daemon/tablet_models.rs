//! What the controls of each model of tablet do, and which model a device is.
//!
//! Law kept here: the tick thread asks, and waits for nobody. A model that is not known yet has the
//! table of all tablets until it is.

use std::collections::BTreeMap;
use std::fmt;
use std::sync::Arc;

use sculptd_devices::DeviceId;
use sculptd_devices::catalogue::Catalogue;
use sculptd_devices::pad_actions::ActionTable;

use crate::adaptors::{Adaptors, SERIAL_IDS};
use crate::config::DevicesConfig;

/// Function that returns the model of a device.
type ModelOf = Arc<dyn Fn(DeviceId) -> Option<String> + Send + Sync>;

/// The tables by model: those of the tablets' files, and those of the settings over them.
#[derive(Debug, Clone, Default)]
pub struct ModelTables {
    /// From the tablet's file: weaker than the settings for all tablets.
    files: BTreeMap<String, ActionTable>,
    /// Of the settings: over what they say of all tablets.
    settings: BTreeMap<String, ActionTable>,
}

impl ModelTables {
    /// From the tablets that are known and the settings.
    pub fn new(catalogue: &Catalogue, config: &DevicesConfig) -> Self {
        let own = |t: &Arc<sculptd_devices::tablet::Tablet>| {
            t.actions.clone().map(|table| (t.name.clone(), table))
        };
        let mut files = BTreeMap::new();
        // The first file of a name is the user's own.
        for (name, table) in catalogue.tablets().iter().filter_map(own) {
            files.entry(name).or_insert(table);
        }
        ModelTables { files, settings: config.model_actions.clone() }
    }

    /// With the adaptors that know the devices.
    pub fn of(self, adaptors: Arc<Adaptors>) -> DeviceTables {
        DeviceTables::new(self, Arc::new(move |device| adaptors.model_of(device)))
    }
}

/// The tables by device.
#[derive(Clone)]
pub struct DeviceTables {
    tables: ModelTables,
    model_of: ModelOf,
}

impl fmt::Debug for DeviceTables {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("DeviceTables").field("tables", &self.tables).finish_non_exhaustive()
    }
}

impl Default for DeviceTables {
    /// Nobody knows a model.
    fn default() -> Self {
        DeviceTables::new(ModelTables::default(), Arc::new(|_| None))
    }
}

impl DeviceTables {
    /// With another way to know a device's model.
    pub fn new(tables: ModelTables, model_of: ModelOf) -> Self {
        DeviceTables { tables, model_of }
    }

    /// The model of a device that has one, where it is known without waiting.
    pub fn model(&self, device: DeviceId) -> Option<String> {
        // Serial pens and recordings have no keys.
        (device.0 < SERIAL_IDS).then(|| (self.model_of)(device)).flatten()
    }

    /// Returns the settings for all tablets, combined with those for this model.
    pub fn table(&self, model: Option<&str>, all: &ActionTable) -> ActionTable {
        let of = |tables: &BTreeMap<String, ActionTable>| {
            model.and_then(|m| tables.get(m)).cloned().unwrap_or_default()
        };
        of(&self.tables.settings).over(all.clone()).over(of(&self.tables.files))
    }
}
