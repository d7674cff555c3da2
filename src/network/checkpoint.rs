//! A world at rest as bytes: its pages, compressed, and everything else, so that a world made of
//! them goes on, to the bit, as the one that they were taken of.
//!
//! Capturing shares the pages and costs the tick thread as much as a published state; the bytes are
//! made by another thread.

use std::io::{Read, Write};
use std::sync::Arc;

use flate2::Compression;
use flate2::read::DeflateDecoder;
use flate2::write::DeflateEncoder;
use serde::{Deserialize, Serialize};

use sculptd_clay::brush::Picture;
use sculptd_clay::page::PageTopology;
use sculptd_clay::{Clay, Levels, ObjectState, Page, Snapshot, Workers};
use sculptd_engine::hand::HandSettings;
use sculptd_engine::scene::SceneView;
use sculptd_engine::world::{Saved, World, WorldOptions};
use sculptd_geometry::TriMesh;

use crate::wire::bytes::{ByteReader, put_bytes, put_number};

/// Bytes that a checkpoint may become: a page's, and all of it.
const MAX_PAGE: usize = 16 << 20;
const MAX_ALL: u64 = 64 << 30;

/// The bytes are not those of a checkpoint.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("the bytes are not those of a checkpoint")]
pub struct BadCheckpoint;

/// A world at rest, shared.
#[derive(Debug, Clone)]
pub struct Captured {
    saved: Saved,
    scene: Arc<SceneView>,
    active: Snapshot,
    options: WorldOptions,
}

/// Everything but the pages.
#[derive(Serialize, Deserialize)]
struct Head {
    tick: u64,
    rest: ObjectState,
    core: Vec<u8>,
    thing: Option<Arc<TriMesh>>,
    picture: Option<Arc<Picture>>,
    options: (u64, u64, HandSettings),
    objects: Vec<ObjectHead>,
}

#[derive(Serialize, Deserialize)]
struct ObjectHead {
    pages: u32,
    levels: Option<Arc<Levels>>,
}

impl Captured {
    /// What a world is now; `None` while anything is under way.
    pub fn of(world: &mut World) -> Option<Captured> {
        let saved = world.save()?;
        let (scene, active, options) = (world.scene_view(), world.snapshot(), *world.options());
        Some(Captured { saved, scene, active, options })
    }

    /// As bytes: the head, then the pages of each object in order, all of it deflated.
    pub fn to_bytes(&self) -> Vec<u8> {
        let each = || self.scene.each(&self.active).map(|(_, clay)| clay);
        let objects = each().map(|clay| ObjectHead {
            pages: clay.page_count() as u32,
            levels: clay.levels().cloned(),
        });
        let (saved, o) = (&self.saved, &self.options);
        let head = Head {
            tick: saved.tick,
            rest: saved.rest.clone(),
            core: saved.core.clone(),
            thing: saved.thing.clone(),
            picture: saved.picture.clone(),
            options: (o.dab_budget, o.undo_bytes, o.hands),
            objects: objects.collect(),
        };
        let mut out = DeflateEncoder::new(Vec::new(), Compression::fast());
        let mut part = Vec::new();
        put_bytes(&mut part, &postcard::to_stdvec(&head).unwrap_or_default());
        // Writing to memory cannot fail.
        let _ = out.write_all(&part);
        for clay in each() {
            for page in clay.pages() {
                part.clear();
                put_number(&mut part, page.revision());
                put_bytes(&mut part, &page.topology().to_bytes());
                put_bytes(&mut part, &page.to_bytes());
                let _ = out.write_all(&part);
            }
        }
        out.finish().unwrap_or_default()
    }

    /// The world again.
    ///
    /// # Errors
    /// [`BadCheckpoint`]
    pub fn restore(bytes: &[u8], workers: Workers) -> Result<World, BadCheckpoint> {
        let mut from = DeflateDecoder::new(bytes).take(MAX_ALL);
        let head = read_bytes(&mut from, MAX_PAGE * 64)?;
        let head: Head = postcard::from_bytes(&head).map_err(|_| BadCheckpoint)?;
        let (dab_budget, undo_bytes, hands) = head.options;
        let mut saved = Saved {
            tick: head.tick,
            rest: head.rest,
            core: head.core,
            thing: head.thing,
            picture: head.picture,
            levels: None,
            steps: (0, 0),
            field_counts: &[],
        };
        let list = saved.scene().map_err(|_| BadCheckpoint)?;
        let active = list.as_ref().map_or(0, |l| l.active as usize);
        let rests: Vec<ObjectState> = match list {
            Some(list) => list.objects.into_iter().map(|o| o.rest).collect(),
            None => vec![saved.rest.clone()],
        };
        if rests.len() != head.objects.len() {
            return Err(BadCheckpoint);
        }
        let mut clays = Vec::new();
        for (i, (rest, object)) in rests.iter().zip(head.objects).enumerate() {
            let mut pages = Vec::new();
            for _ in 0..object.pages {
                let revision = read_number(&mut from)?;
                let topology = PageTopology::from_bytes(&read_bytes(&mut from, MAX_PAGE)?);
                let topology = Arc::new(topology.map_err(|_| BadCheckpoint)?);
                let bytes = read_bytes(&mut from, MAX_PAGE)?;
                let page = Page::from_bytes(&bytes, topology, revision);
                pages.push(Arc::new(page.map_err(|_| BadCheckpoint)?));
            }
            let mut clay = Clay::of_stored(pages, rest).map_err(|_| BadCheckpoint)?;
            clay.set_empty(rest.empty.clone());
            match i == active {
                true => saved.levels = object.levels,
                false => clay.set_levels(object.levels),
            }
            clays.push(clay);
        }
        let options = WorldOptions { dab_budget, undo_bytes, hands };
        World::restore(clays, saved, workers, options).map_err(|_| BadCheckpoint)
    }
}

fn read_number(from: &mut impl Read) -> Result<u64, BadCheckpoint> {
    let mut bytes = Vec::with_capacity(10);
    loop {
        let mut byte = [0];
        from.read_exact(&mut byte).map_err(|_| BadCheckpoint)?;
        bytes.push(byte[0]);
        if byte[0] & 0x80 == 0 || bytes.len() == 10 {
            return ByteReader::new(&bytes).number().map_err(|_| BadCheckpoint);
        }
    }
}

fn read_bytes(from: &mut impl Read, most: usize) -> Result<Vec<u8>, BadCheckpoint> {
    let length = read_number(from)?;
    if length > most as u64 {
        return Err(BadCheckpoint);
    }
    // What is told may be more than there is: memory grows with what comes.
    let mut bytes = Vec::new();
    let read = from.take(length).read_to_end(&mut bytes).map_err(|_| BadCheckpoint)?;
    if read as u64 == length { Ok(bytes) } else { Err(BadCheckpoint) }
}
