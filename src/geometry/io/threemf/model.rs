//! One model part: its objects, their meshes and properties, and the build list.

use std::collections::{BTreeMap, BTreeSet};

use glam::{DMat4, DVec3, DVec4};
use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};

use super::painting::{TrianglePaint, paint_of};
use super::resources::{Breach, ResourceKind, Resources, colour};
use super::{ParseError, PartName, ThreemfObject, ThreemfPackage, bad, get, text_for_people};
use crate::PolyMesh;
use crate::io::problem::FilePlace;
use crate::io::text::{float, integer, refuse};
use crate::job::Job;

/// How the names of the 3MF Consortium's extensions begin.
const NAMESPACES: &str = "http://schemas.microsoft.com/3dmanufacturing";
/// Extensions that a file may require: their parts are read, or named in a warning.
const EXTENSIONS: [&str; 5] =
    ["/core/", "/material/", "/production/", "/trianglesets/", "/beamlattice/"];

/// Kinds of objects (core specification, 4.1).
const OBJECT_TYPES: [&str; 5] = ["model", "solidsupport", "support", "surface", "other"];
/// What a texture may be.
const TEXTURES: [&str; 2] = ["image/png", "image/jpeg"];

/// Reads a model part into the package. `root`: the part that the package's relationships name.
pub(super) fn read(
    text: &[u8],
    (path, root): (&str, bool),
    package: &mut ThreemfPackage,
    job: &Job,
) -> Result<(), ParseError> {
    let text =
        std::str::from_utf8(text.strip_prefix(b"\xef\xbb\xbf").unwrap_or(text)).map_err(|e| {
            bad(FilePlace::Byte(e.valid_up_to() as u64), format!("UTF-8 in {path}"), "other bytes")
        })?;
    let mut reader = Reader::from_str(text);
    let mut part = ModelPart {
        path,
        root,
        package,
        resources: Resources::default(),
        object: None,
        group: None,
        metadata: BTreeSet::new(),
        namespaces: BTreeMap::new(),
        ignorable: Vec::new(),
        models: 0,
        is_built: false,
        at: FilePlace::File,
    };
    if root {
        part.package.unit = 1.0;
    }
    let mut count = 0u32;
    loop {
        count = count.wrapping_add(1);
        if count.is_multiple_of(1 << 14) {
            job.check()?;
        }
        part.at = FilePlace::Byte(reader.buffer_position());
        let event = reader.read_event();
        match event.map_err(|e| part.wrong("well-formed XML", e.to_string()))? {
            Event::Start(e) => part.element(&e, false)?,
            Event::Empty(e) => part.element(&e, true)?,
            Event::End(e) if e.local_name().as_ref() == "object" => part.end_object(),
            Event::DocType(_) => return Err(part.wrong("no DTD", "a document type".into())),
            Event::Eof => break,
            _ => {}
        }
    }
    if root && !part.is_built {
        return Err(part.wrong("a <build>", "none".into()));
    }
    Ok(())
}

/// An object that is being read.
struct OpenObject {
    id: i64,
    object: ThreemfObject,
    /// Property of the faces that name none: group and index.
    property: Option<(i64, i64)>,
}

/// A part on the way.
struct ModelPart<'a> {
    path: &'a str,
    root: bool,
    package: &'a mut ThreemfPackage,
    resources: Resources,
    object: Option<OpenObject>,
    /// The group of properties whose entries follow.
    group: Option<(i64, ResourceKind)>,
    metadata: BTreeSet<String>,
    /// Namespaces by prefix.
    namespaces: BTreeMap<String, String>,
    /// Prefixes that a reader may ignore.
    ignorable: Vec<String>,
    models: usize,
    is_built: bool,
    /// Place of the element, for messages.
    at: FilePlace,
}

impl ModelPart<'_> {
    fn wrong(&self, expected: &str, found: String) -> ParseError {
        bad(self.at, format!("{expected} (in {})", self.path), found)
    }

    fn breach(&self, (expected, found): Breach) -> ParseError {
        self.wrong(&expected, found)
    }

    fn text(&self, e: &BytesStart, name: &str) -> Result<String, ParseError> {
        get(e, name).ok_or_else(|| self.wrong(&format!("the attribute \"{name}\""), "none".into()))
    }

    fn number(&self, e: &BytesStart, name: &str) -> Result<f64, ParseError> {
        let text = self.text(e, name)?;
        let value = float(text.as_bytes())
            .ok_or_else(|| self.wrong(&format!("a number as \"{name}\""), text))?;
        match refuse(value) {
            None => Ok(value),
            Some(found) => Err(self.wrong("a finite number", found.into())),
        }
    }

    fn index(&self, e: &BytesStart, name: &str) -> Result<i64, ParseError> {
        let text = self.text(e, name)?;
        integer(text.as_bytes())
            .ok_or_else(|| self.wrong(&format!("a whole number as \"{name}\""), text))
    }

    /// A whole number, if the attribute is there.
    fn optional(&self, e: &BytesStart, name: &str) -> Result<Option<i64>, ParseError> {
        get(e, name).map(|_| self.index(e, name)).transpose()
    }

    /// Whole numbers in a row.
    fn indices(&self, e: &BytesStart, name: &str) -> Result<Vec<i64>, ParseError> {
        let text = self.text(e, name)?;
        let all = text.split_ascii_whitespace().map(|word| integer(word.as_bytes()));
        let all: Option<Vec<i64>> = all.collect();
        all.filter(|all| !all.is_empty())
            .ok_or_else(|| self.wrong(&format!("whole numbers as \"{name}\""), text))
    }

    fn target(&self, e: &BytesStart) -> Result<(PartName, DMat4), ParseError> {
        let place =
            get(e, "path").map_or(self.path.to_string(), |p| p.trim_start_matches('/').to_string());
        let transform = match get(e, "transform") {
            None => DMat4::IDENTITY,
            Some(t) => transform(&t)
                .ok_or_else(|| self.wrong("twelve numbers of an invertible \"transform\"", t))?,
        };
        Ok(((place, self.index(e, "objectid")?), transform))
    }

    /// Checks the names of an element and of its attributes: nothing is of XML Schema's own
    /// namespace or of an unknown one of the consortium's (core specification, 2.3).
    fn check_names(&mut self, e: &BytesStart) -> Result<(), ParseError> {
        for attribute in e.attributes().filter_map(Result::ok) {
            if let Some(prefix) = attribute.key.as_ref().strip_prefix("xmlns:") {
                self.namespaces.insert(prefix.to_owned(), attribute.value.to_string());
            }
        }
        for attribute in e.attributes().filter_map(Result::ok) {
            let name: &str = attribute.key.as_ref();
            match name.split_once(':') {
                Some(("xmlns", _)) | None => {}
                Some(("xml", "lang")) => {}
                Some(("xml", _)) => return Err(self.wrong("no xml: but xml:lang", name.into())),
                Some((prefix, local)) => {
                    if local == "Ignorable" {
                        let words = attribute.value.split_ascii_whitespace();
                        self.ignorable.extend(words.map(str::to_owned));
                    }
                    self.check_prefix(prefix, name)?;
                }
            }
        }
        let name = e.name();
        let name: &str = name.as_ref();
        match name.split_once(':') {
            Some((prefix, _)) => self.check_prefix(prefix, name),
            None => Ok(()),
        }
    }

    fn check_prefix(&self, prefix: &str, name: &str) -> Result<(), ParseError> {
        // Common writers leave some prefixes undeclared: such names are passed over.
        let Some(space) = self.namespaces.get(prefix) else { return Ok(()) };
        let schema = space.ends_with("/XMLSchema-instance");
        let unknown = space.starts_with(NAMESPACES)
            && !is_known(space)
            && !space.contains("/2013/")
            && !self.ignorable.iter().any(|ignorable| ignorable == prefix);
        match schema || unknown && !KNOWN_UNREAD.iter().any(|known| space.contains(known)) {
            true => Err(self.wrong("names of known namespaces, or ignorable ones", name.into())),
            false => Ok(()),
        }
    }

    fn element(&mut self, e: &BytesStart, empty: bool) -> Result<(), ParseError> {
        self.check_names(e)?;
        let name = e.local_name();
        let name: &str = name.as_ref();
        match name {
            "model" => self.model(e)?,
            "metadata" if self.object.is_none() => {
                let name = self.text(e, "name")?;
                if !self.metadata.insert(name.clone()) {
                    return Err(self.wrong("each name of metadata once", name));
                }
            }
            "object" => self.begin_object(e, empty)?,
            "vertex" => {
                let place =
                    DVec3::new(self.number(e, "x")?, self.number(e, "y")?, self.number(e, "z")?);
                if let Some(now) = &mut self.object {
                    now.object.mesh.positions.push(place);
                }
            }
            "triangle" => self.triangle(e)?,
            "beam" | "ball" => self.package.beams += 1,
            "slicestack" => self.package.slices += 1,
            "component" => {
                let target = self.target(e)?;
                if let Some(now) = &mut self.object {
                    now.object.components.push(target);
                }
            }
            "build" => self.is_built = true,
            "item" if self.root => {
                let (target, place) = self.target(e)?;
                let found = self.package.objects.get(&target);
                if found.is_some_and(|object| object.other) {
                    let text = format!("object {}, of type other", target.1);
                    return Err(self.wrong("items of objects that are built", text));
                }
                self.package.build.push((target, place));
            }
            _ => self.property(e, name, empty)?,
        }
        Ok(())
    }

    fn model(&mut self, e: &BytesStart) -> Result<(), ParseError> {
        self.models += 1;
        if self.models > 1 {
            return Err(self.wrong("one <model>", "another".into()));
        }
        for prefix in get(e, "requiredextensions").unwrap_or_default().split_whitespace() {
            let space = self.namespaces.get(prefix).cloned().unwrap_or_else(|| prefix.into());
            if !(space.starts_with(NAMESPACES) && is_known(&space)) {
                return Err(self.wrong("required extensions that are known here", space));
            }
        }
        if !self.root {
            return Ok(());
        }
        self.package.unit = match get(e, "unit").as_deref() {
            None | Some("millimeter") => 1.0,
            Some("micron") => 1e-3,
            Some("centimeter") => 10.0,
            Some("inch") => 25.4,
            Some("foot") => 304.8,
            Some("meter") => 1e3,
            Some(other) => {
                let expected = "micron, millimeter, centimeter, inch, foot or meter";
                return Err(self.wrong(expected, other.into()));
            }
        };
        Ok(())
    }

    fn begin_object(&mut self, e: &BytesStart, empty: bool) -> Result<(), ParseError> {
        let id = self.index(e, "id")?;
        self.resources.add(id, ResourceKind::Object).map_err(|b| self.breach(b))?;
        let kind = get(e, "type").unwrap_or_else(|| "model".into());
        if !OBJECT_TYPES.contains(&kind.as_str()) {
            return Err(self.wrong(&OBJECT_TYPES.join(", "), kind));
        }
        let (group, index) = (self.optional(e, "pid")?, self.optional(e, "pindex")?);
        let property = match (group, index) {
            (None, None) => None,
            (None, Some(_)) => return Err(self.wrong("a pid beside the pindex", "none".into())),
            (Some(group), index) => Some((group, index.unwrap_or(0))),
        };
        if let Some((group, index)) = property {
            self.resources.check_entry(group, index).map_err(|b| self.breach(b))?;
        }
        let object = ThreemfObject {
            mesh: PolyMesh::new(),
            other: kind == "other",
            support: matches!(&*kind, "support" | "solidsupport"),
            name: text_for_people(e, "name"),
            ..ThreemfObject::default()
        };
        self.object = Some(OpenObject { id, object, property });
        if empty {
            self.end_object();
        }
        Ok(())
    }

    fn end_object(&mut self) {
        if let Some(now) = self.object.take() {
            self.package.objects.insert((self.path.to_string(), now.id), now.object);
        }
    }

    fn triangle(&mut self, e: &BytesStart) -> Result<(), ParseError> {
        let Some(now) = &self.object else { return Ok(()) };
        let n = now.object.mesh.positions.len() as i64;
        let mut corners = [0; 3];
        for (c, name) in corners.iter_mut().zip(["v1", "v2", "v3"]) {
            let i = self.index(e, name)?;
            if !(0..n).contains(&i) {
                return Err(self.wrong(&format!("a vertex index below {n}"), i.to_string()));
            }
            *c = i as u32;
        }
        let colours = self.colours_of(e, now.property)?;
        let [prusa, orca] = ["mmu_segmentation", "paint_color"].map(|name| get(e, name));
        let paint = paint_of(prusa.as_deref(), orca.as_deref());
        let Some(now) = &mut self.object else { return Ok(()) };
        let faces = now.object.mesh.face_count();
        now.object.mesh.push_face(&corners);
        if colours != [None; 3] || !now.object.colours.is_empty() {
            // Those before had none.
            now.object.colours.resize(faces, [None; 3]);
            now.object.colours.push(colours);
        }
        if paint != TrianglePaint::None || !now.object.painting.is_empty() {
            now.object.painting.resize(faces, TrianglePaint::None);
            now.object.painting.push(paint);
        }
        Ok(())
    }

    /// The colours of a triangle's corners: of its own property, or of its object's.
    fn colours_of(
        &self,
        e: &BytesStart,
        default: Option<(i64, i64)>,
    ) -> Result<[Option<[u8; 4]>; 3], ParseError> {
        let Some(first) = self.optional(e, "p1")? else {
            return Ok([default.and_then(|(group, index)| self.resources.colour(group, index)); 3]);
        };
        let own = self.optional(e, "pid")?;
        let group = own.or(default.map(|(group, _)| group));
        let group = group.ok_or_else(|| self.wrong("a pid beside p1", "none".into()))?;
        let indices = [
            first,
            self.optional(e, "p2")?.unwrap_or(first),
            self.optional(e, "p3")?.unwrap_or(first),
        ];
        let mut colours = [None; 3];
        for (colour, index) in colours.iter_mut().zip(indices) {
            self.resources.check_entry(group, index).map_err(|b| self.breach(b))?;
            *colour = self.resources.colour(group, index);
        }
        Ok(colours)
    }

    /// Groups of properties, and their entries.
    fn property(&mut self, e: &BytesStart, name: &str, empty: bool) -> Result<(), ParseError> {
        if let Some((id, kind)) = self.group
            && name == kind.entry()
        {
            let key = match kind {
                ResourceKind::BaseMaterials => Some("displaycolor"),
                ResourceKind::Colours => Some("color"),
                _ => None,
            };
            let text = match (kind, key) {
                (ResourceKind::Colours, Some(key)) => Some(self.text(e, key)?),
                (_, Some(key)) => get(e, key),
                _ => None,
            };
            let found = text.map(|text| {
                colour(&text).ok_or_else(|| self.wrong("a colour #RRGGBB or #RRGGBBAA", text))
            });
            let found = found.transpose()?;
            if kind == ResourceKind::BaseMaterials {
                self.package.materials.push(found);
            }
            self.resources.add_entry(id, found);
            return Ok(());
        }
        let Some(kind) = ResourceKind::of_element(name) else {
            // A resource of an extension that is not read may be named by faces all the same.
            if self.object.is_none()
                && let Some(id) = get(e, "id").and_then(|id| integer(id.as_bytes()))
                && name.ends_with("group")
            {
                return self.resources.add(id, ResourceKind::Other).map_err(|b| self.breach(b));
            }
            return Ok(());
        };
        let id = self.index(e, "id")?;
        match kind {
            ResourceKind::Texture => {
                self.text(e, "path")?;
                let content = self.text(e, "contenttype")?;
                if !TEXTURES.contains(&content.as_str()) {
                    return Err(self.wrong("image/png or image/jpeg as \"contenttype\"", content));
                }
            }
            ResourceKind::TextureCoordinates => {
                let texture = self.index(e, "texid")?;
                if self.resources.kind(texture) != Some(ResourceKind::Texture) {
                    return Err(self.wrong("a texture2d as \"texid\"", texture.to_string()));
                }
            }
            ResourceKind::Composites => {
                let materials = self.index(e, "matid")?;
                if self.resources.kind(materials) != Some(ResourceKind::BaseMaterials) {
                    return Err(self.wrong("basematerials as \"matid\"", materials.to_string()));
                }
                for index in self.indices(e, "matindices")? {
                    self.resources.check_entry(materials, index).map_err(|b| self.breach(b))?;
                }
            }
            ResourceKind::Multi => {
                let layers = self.indices(e, "pids")?;
                self.resources.check_layers(&layers).map_err(|b| self.breach(b))?;
            }
            _ => {}
        }
        self.resources.add(id, kind).map_err(|b| self.breach(b))?;
        if matches!(
            kind,
            ResourceKind::TextureCoordinates | ResourceKind::Composites | ResourceKind::Multi
        ) {
            self.package.properties += 1;
        }
        if !empty {
            self.group = Some((id, kind));
        }
        Ok(())
    }
}

/// Extensions of the consortium's whose parts are passed over.
const KNOWN_UNREAD: [&str; 4] = ["/slice/", "/securecontent/", "/displacement/", "/volumetric/"];

fn is_known(space: &str) -> bool {
    EXTENSIONS.iter().any(|known| space.contains(known))
}

/// Twelve numbers, a row vector's matrix by rows; `None` of one without an inverse.
fn transform(text: &str) -> Option<DMat4> {
    let v: Vec<f64> = text
        .split_ascii_whitespace()
        .map(|w| float(w.as_bytes()).filter(|v| v.is_finite()))
        .collect::<Option<_>>()?;
    let row = |i: usize, w: f64| DVec4::new(v[i], v[i + 1], v[i + 2], w);
    let matrix = (v.len() == 12)
        .then(|| DMat4::from_cols(row(0, 0.0), row(3, 0.0), row(6, 0.0), row(9, 1.0)));
    // A part that is pressed flat has no volume (3MF core specification, 3.3).
    matrix.filter(|m| m.determinant() != 0.0)
}
