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
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use sculptd_clay::brush::Picture;
use sculptd_clay::page::PageTopology;
use sculptd_clay::{Clay, Levels, ObjectState, Page, Snapshot, Workers};
use sculptd_engine::hand::HandSettings;
use sculptd_engine::scene::SceneView;
use sculptd_engine::world::{Saved, World, WorldOptions};
use sculptd_geometry::TriMesh;

use crate::wire::bytes::{ByteReader, put_bytes, put_number};

/// Bytes that a page may become, and the head.
const MAX_PAGE: u64 = 16 << 20;
const MAX_HEAD: u64 = 1 << 30;
/// Pages of a block.
const BLOCK: usize = 32;

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

    /// As bytes: the head, then the pages of each object in order, some to a block; each block is
    /// deflated by itself, on all cores.
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
        let mut out = Vec::new();
        put_bytes(&mut out, &deflated(&postcard::to_stdvec(&head).unwrap_or_default()));
        for clay in each() {
            let pages: Vec<&Arc<Page>> = clay.pages().collect();
            let block = |some: &[&Arc<Page>]| {
                let mut part = Vec::new();
                for page in some {
                    put_number(&mut part, page.revision());
                    put_bytes(&mut part, &page.topology().to_bytes());
                    put_bytes(&mut part, &page.to_bytes());
                }
                deflated(&part)
            };
            let blocks: Vec<Vec<u8>> = pages.par_chunks(BLOCK).map(block).collect();
            blocks.iter().for_each(|b| put_bytes(&mut out, b));
        }
        out
    }

    /// The world again.
    ///
    /// # Errors
    /// [`BadCheckpoint`]
    pub fn restore(bytes: &[u8], workers: Workers) -> Result<World, BadCheckpoint> {
        let mut from = ByteReader::new(bytes);
        let head = inflated(from.bytes(usize::MAX).map_err(|_| BadCheckpoint)?, MAX_HEAD)?;
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
            let blocks = (object.pages as usize).div_ceil(BLOCK);
            let mut parts = Vec::new();
            for _ in 0..blocks {
                parts.push(from.bytes(usize::MAX).map_err(|_| BadCheckpoint)?);
            }
            let read = |(i, part): (usize, &&[u8])| {
                pages_of(part, BLOCK.min(object.pages as usize - i * BLOCK))
            };
            let pages: Result<Vec<_>, BadCheckpoint> =
                parts.par_iter().enumerate().map(read).collect();
            let pages = pages?.into_iter().flatten().collect();
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

/// The pages of one block.
fn pages_of(block: &[u8], count: usize) -> Result<Vec<Arc<Page>>, BadCheckpoint> {
    let bytes = inflated(block, MAX_PAGE * BLOCK as u64)?;
    let mut from = ByteReader::new(&bytes);
    let mut pages = Vec::with_capacity(count);
    for _ in 0..count {
        let revision = from.number().map_err(|_| BadCheckpoint)?;
        let topology = PageTopology::from_bytes(from.bytes(usize::MAX).map_err(|_| BadCheckpoint)?);
        let topology = Arc::new(topology.map_err(|_| BadCheckpoint)?);
        let bytes = from.bytes(usize::MAX).map_err(|_| BadCheckpoint)?;
        let page = Page::from_bytes(bytes, topology, revision);
        pages.push(Arc::new(page.map_err(|_| BadCheckpoint)?));
    }
    Ok(pages)
}

fn deflated(bytes: &[u8]) -> Vec<u8> {
    let mut out = DeflateEncoder::new(Vec::new(), Compression::fast());
    // Writing to memory cannot fail.
    let _ = out.write_all(bytes);
    out.finish().unwrap_or_default()
}

/// Memory grows with what comes, not with what is told.
fn inflated(bytes: &[u8], most: u64) -> Result<Vec<u8>, BadCheckpoint> {
    let mut out = Vec::new();
    let read = DeflateDecoder::new(bytes).take(most).read_to_end(&mut out);
    read.map(|_| out).map_err(|_| BadCheckpoint)
}
