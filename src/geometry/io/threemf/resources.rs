//! The resources of a model part: what the core and the materials specifications ask of them, and
//! the colours that they hold.

use std::collections::BTreeMap;

/// Kinds of resources that faces may refer to, and textures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ResourceKind {
    BaseMaterials,
    Colours,
    TextureCoordinates,
    Composites,
    Multi,
    Texture,
    Object,
    /// Of an extension that is not read.
    Other,
}

impl ResourceKind {
    pub(super) fn of_element(name: &str) -> Option<ResourceKind> {
        Some(match name {
            "basematerials" => ResourceKind::BaseMaterials,
            "colorgroup" => ResourceKind::Colours,
            "texture2dgroup" => ResourceKind::TextureCoordinates,
            "compositematerials" => ResourceKind::Composites,
            "multiproperties" => ResourceKind::Multi,
            "texture2d" => ResourceKind::Texture,
            _ => return None,
        })
    }

    /// The element of one entry.
    pub(super) fn entry(self) -> &'static str {
        match self {
            ResourceKind::BaseMaterials => "base",
            ResourceKind::Colours => "color",
            ResourceKind::TextureCoordinates => "tex2coord",
            ResourceKind::Composites => "composite",
            ResourceKind::Multi => "multi",
            ResourceKind::Texture | ResourceKind::Object | ResourceKind::Other => "",
        }
    }
}

/// A resource: its kind, and the colours of its entries.
#[derive(Debug)]
pub(super) struct Resource {
    pub(super) kind: ResourceKind,
    pub(super) colours: Vec<Option<[u8; 4]>>,
}

/// The resources of a model part by number.
#[derive(Debug, Default)]
pub(super) struct Resources(BTreeMap<i64, Resource>);

/// What was expected, and what was found.
pub(super) type Breach = (String, String);

impl Resources {
    /// Adds a resource.
    ///
    /// # Errors
    /// Its number is taken.
    pub(super) fn add(&mut self, id: i64, kind: ResourceKind) -> Result<(), Breach> {
        let new = Resource { kind, colours: Vec::new() };
        match self.0.insert(id, new) {
            None => Ok(()),
            Some(_) => Err(("each resource id once".into(), format!("id {id} again"))),
        }
    }

    /// Adds an entry to a resource.
    pub(super) fn add_entry(&mut self, id: i64, colour: Option<[u8; 4]>) {
        if let Some(resource) = self.0.get_mut(&id) {
            resource.colours.push(colour);
        }
    }

    pub(super) fn kind(&self, id: i64) -> Option<ResourceKind> {
        self.0.get(&id).map(|resource| resource.kind)
    }

    /// Checks that faces may refer to entry `index` of `id`.
    ///
    /// # Errors
    /// There is no such resource, it is of another kind, or it has fewer entries.
    pub(super) fn check_entry(&self, id: i64, index: i64) -> Result<(), Breach> {
        let of = |found: &str| ("a pid of a group of properties".to_owned(), found.to_owned());
        let resource = self.0.get(&id).ok_or_else(|| of(&format!("no resource {id}")))?;
        match resource.kind {
            ResourceKind::Texture | ResourceKind::Object => Err(of(&format!("resource {id}"))),
            ResourceKind::Other => Ok(()),
            _ => {
                let count = resource.colours.len() as i64;
                let expected = format!("an index below {count} into resource {id}");
                let holds = (0..count).contains(&index);
                if holds { Ok(()) } else { Err((expected, index.to_string())) }
            }
        }
    }

    /// Returns the colour of an entry; `None`: it has none, or its group is not read.
    pub(super) fn colour(&self, id: i64, index: i64) -> Option<[u8; 4]> {
        let resource = self.0.get(&id)?;
        *resource.colours.get(usize::try_from(index).ok()?)?
    }

    /// Checks the groups that multiproperties name: at most one of materials, one of colours, and
    /// none of multiproperties (materials specification, chapter 5).
    ///
    /// # Errors
    /// Says which rule is broken.
    pub(super) fn check_layers(&self, ids: &[i64]) -> Result<(), Breach> {
        let (mut materials, mut colours) = (0, 0);
        for id in ids {
            match self.kind(*id) {
                Some(ResourceKind::BaseMaterials | ResourceKind::Composites) => materials += 1,
                Some(ResourceKind::Colours) => colours += 1,
                Some(
                    ResourceKind::TextureCoordinates | ResourceKind::Texture | ResourceKind::Other,
                ) => {}
                found => {
                    let expected = "groups of materials, colours or texture coordinates as pids";
                    let found = match found {
                        Some(kind) => format!("resource {id}, {kind:?}"),
                        None => format!("no resource {id}"),
                    };
                    return Err((expected.into(), found));
                }
            }
        }
        if materials > 1 || colours > 1 {
            let expected = "at most one group of materials and one of colours as pids";
            return Err((expected.into(), format!("{materials} and {colours}")));
        }
        Ok(())
    }
}

/// Reads `#RRGGBB` or `#RRGGBBAA`.
pub(super) fn colour(text: &str) -> Option<[u8; 4]> {
    let digits = text.strip_prefix('#').filter(|d| d.bytes().all(|b| b.is_ascii_hexdigit()))?;
    let byte = |i: usize| u8::from_str_radix(digits.get(i * 2..i * 2 + 2)?, 16).ok();
    match digits.len() {
        6 => Some([byte(0)?, byte(1)?, byte(2)?, 255]),
        8 => Some([byte(0)?, byte(1)?, byte(2)?, byte(3)?]),
        _ => None,
    }
}
