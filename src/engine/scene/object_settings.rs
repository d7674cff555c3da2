//! Everything of an object but its clay, and its encoding in a file.
//!
//! The bytes are the fields in order, as every struct's (postcard), except that one byte of flags
//! replaces `locked`: bit 0 is `locked`, and bit 1 means that [`Extras`] follow. Settings without
//! extras have the same bytes as before extras existed.

use std::collections::BTreeMap;
use std::fmt;

use serde::de::{Error, SeqAccess, Visitor};
use serde::ser::SerializeStruct;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::{LiveBoolean, ObjectTransform, Primitive};

/// Everything of an object but its clay.
#[derive(Debug, Clone, PartialEq)]
pub struct ObjectSettings {
    /// For people; several objects may have the same. At most [`super::MAX_NAME`] characters.
    pub name: String,
    /// Its place in the world.
    pub transform: ObjectTransform,
    /// True if it is drawn, and included when the visible objects are written.
    pub visible: bool,
    /// Strokes, Booleans, transforms and removal are refused.
    pub locked: bool,
    /// The numbers that it was made of, which can be changed as long as nothing has changed its
    /// clay.
    pub primitive: Option<Primitive>,
    /// The name of the group that it is listed in; empty: none.
    pub group: String,
    /// The names of its face sets, by their numbers. A set without one goes by its number.
    pub set_names: BTreeMap<u16, String>,
    /// The Boolean that it is the result of, where it follows its operands.
    pub live: Option<Box<LiveBoolean>>,
}

/// Settings added after the original fields.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
enum Extra {
    Group(String),
    SetName(u16, String),
    Live(Box<LiveBoolean>),
}

/// A list, so that more kinds can be added behind these.
type Extras = Vec<Extra>;

const LOCKED: u8 = 1;
const HAS_EXTRAS: u8 = 2;
const FIELDS: &[&str] = &["name", "transform", "visible", "flags", "primitive", "extras"];

impl Default for ObjectSettings {
    fn default() -> Self {
        ObjectSettings {
            name: "object".into(),
            transform: ObjectTransform::NONE,
            visible: true,
            locked: false,
            primitive: None,
            group: String::new(),
            set_names: BTreeMap::new(),
            live: None,
        }
    }
}

impl ObjectSettings {
    fn extras(&self) -> Extras {
        let group = (!self.group.is_empty()).then(|| Extra::Group(self.group.clone()));
        let names = self.set_names.iter().map(|(set, name)| Extra::SetName(*set, name.clone()));
        group.into_iter().chain(names).chain(self.live.clone().map(Extra::Live)).collect()
    }
}

impl Serialize for ObjectSettings {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        let extras = self.extras();
        let flags = u8::from(self.locked) * LOCKED + u8::from(!extras.is_empty()) * HAS_EXTRAS;
        let mut out = to.serialize_struct("ObjectSettings", FIELDS.len())?;
        out.serialize_field("name", &self.name)?;
        out.serialize_field("transform", &self.transform)?;
        out.serialize_field("visible", &self.visible)?;
        out.serialize_field("flags", &flags)?;
        out.serialize_field("primitive", &self.primitive)?;
        if !extras.is_empty() {
            out.serialize_field("extras", &extras)?;
        }
        out.end()
    }
}

impl<'de> Deserialize<'de> for ObjectSettings {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        from.deserialize_struct("ObjectSettings", FIELDS, SettingsVisitor)
    }
}

struct SettingsVisitor;

impl<'de> Visitor<'de> for SettingsVisitor {
    type Value = ObjectSettings;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("the settings of an object")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut all: A) -> Result<ObjectSettings, A::Error> {
        fn next<'de, T: Deserialize<'de>, A: SeqAccess<'de>>(all: &mut A) -> Result<T, A::Error> {
            all.next_element()?.ok_or_else(|| A::Error::custom("settings end too early"))
        }
        let mut settings = ObjectSettings {
            name: next(&mut all)?,
            transform: next(&mut all)?,
            visible: next(&mut all)?,
            ..ObjectSettings::default()
        };
        let flags: u8 = next(&mut all)?;
        settings.primitive = next(&mut all)?;
        settings.locked = flags & LOCKED != 0;
        if flags & !(LOCKED | HAS_EXTRAS) != 0 {
            return Err(A::Error::custom("unknown flags of an object"));
        }
        let extras: Extras = if flags & HAS_EXTRAS != 0 { next(&mut all)? } else { Vec::new() };
        for extra in extras {
            match extra {
                Extra::Group(name) => settings.group = name,
                Extra::SetName(set, name) => {
                    settings.set_names.insert(set, name);
                }
                Extra::Live(live) => settings.live = Some(live),
            }
        }
        Ok(settings)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{ObjectId, Operand};
    use sculptd_geometry::boolean::Operation;

    /// The struct before there were extras.
    #[derive(Serialize, Deserialize)]
    struct SettingsBefore {
        name: String,
        transform: ObjectTransform,
        visible: bool,
        locked: bool,
        primitive: Option<Primitive>,
    }

    #[test]
    fn settings_without_extras_have_the_bytes_that_they_had_and_with_some_come_back() {
        for locked in [false, true] {
            let plain = ObjectSettings { name: "pig".into(), locked, ..Default::default() };
            let before = SettingsBefore {
                name: "pig".into(),
                transform: plain.transform,
                visible: true,
                locked,
                primitive: None,
            };
            let (old, new) = (postcard::to_stdvec(&before), postcard::to_stdvec(&plain));
            let bytes = new.expect("plain data");
            assert_eq!(old.expect("plain data"), bytes);
            assert_eq!(postcard::from_bytes::<ObjectSettings>(&bytes).expect("read"), plain);
            let operand =
                Operand { id: ObjectId(3), clay: 4, revision: 5, transform: plain.transform };
            let live = LiveBoolean {
                operation: Operation::Difference,
                operands: [operand; 2],
                keep_contact: true,
                tolerance: Some(0.5),
                result: 9,
            };
            let rich = ObjectSettings {
                group: "legs".into(),
                set_names: [(2, "hoof".into()), (7, "knee".into())].into(),
                live: Some(Box::new(live)),
                ..plain
            };
            // Another value follows it, as in a list.
            let bytes = postcard::to_stdvec(&(&rich, 77u32)).expect("plain data");
            let back: (ObjectSettings, u32) = postcard::from_bytes(&bytes).expect("read");
            assert_eq!(back, (rich, 77));
        }
    }
}
