//! A world at rest as bytes: its pages, compressed, and everything else, so that a world made of
//! them goes on, to the bit, as the one that they were taken of.
//!
//! Capturing shares the pages and costs the tick thread as much as a published state; the bytes are
//! made by another thread.

use std::io::Read;
use std::sync::Arc;

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use sculptd_clay::brush::Picture;
use sculptd_clay::{Clay, Levels, ObjectState, Page, Snapshot, Workers};
use sculptd_geometry::TriMesh;

use crate::hand::HandSettings;
use crate::scene::SceneView;
use crate::world::{Saved, World, WorldOptions};

/// Bytes that a page may become, and the head.
const MAX_PAGE: u64 = 16 << 20;
const MAX_HEAD: u64 = 1 << 30;
/// Pages of a block.
const BLOCK: usize = 32;
/// Blocks that are made or read side by side.
const AT_ONCE: usize = 8;
/// Of the compression: the quickest. Of the planes of pages, others gain little.
const LEVEL: i32 = 1;

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
    /// Captures the current world; returns `None` while anything is under way.
    pub fn of(world: &mut World) -> Option<Captured> {
        let saved = world.save()?;
        let (scene, active, options) = (world.scene_view(), world.snapshot(), *world.options());
        Some(Captured { saved, scene, active, options })
    }

    /// As bytes, part by part as they are made on all cores: the head, then the pages of each
    /// object in order, some to a block; head and blocks are compressed by themselves, and the
    /// length of each is before it. `put` takes each part, and whether it is the last.
    pub fn write(&self, mut put: impl FnMut(&[u8], bool)) {
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
        put_part(&mut out, &compressed(&postcard::to_stdvec(&head).unwrap_or_default()));
        put(&out, false);
        for clay in each() {
            let pages: Vec<&Arc<Page>> = clay.pages().collect();
            for some in pages.chunks(BLOCK * AT_ONCE) {
                let blocks: Vec<Vec<u8>> = some.par_chunks(BLOCK).map(block_of).collect();
                out.clear();
                blocks.iter().for_each(|b| put_part(&mut out, b));
                put(&out, false);
            }
        }
        put(&[], true);
    }

    /// All of [`Captured::write`] in a row.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut out = Vec::new();
        self.write(|part, _| out.extend_from_slice(part));
        out
    }
}

/// Makes a world of the bytes of a checkpoint, as they come.
#[derive(Default)]
pub struct Restoring {
    /// Bytes received that do not yet complete a part.
    rest: Vec<u8>,
    head: Option<Head>,
    /// Parts that are whole, compressed.
    blocks: Vec<Vec<u8>>,
    pages: Vec<Arc<Page>>,
}

impl std::fmt::Debug for Restoring {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Restoring").field("pages", &self.pages.len()).finish_non_exhaustive()
    }
}

impl Restoring {
    /// Takes the next bytes.
    ///
    /// # Errors
    /// [`BadCheckpoint`]
    pub fn take(&mut self, bytes: &[u8]) -> Result<(), BadCheckpoint> {
        self.rest.extend_from_slice(bytes);
        let mut used = 0;
        // An incomplete part is read again together with the bytes that follow.
        while let Some((length, rest)) = self.rest[used..].split_first_chunk::<4>()
            && let Some(part) = rest.get(..u32::from_le_bytes(*length) as usize)
        {
            used += 4 + part.len();
            match &self.head {
                Some(_) => self.blocks.push(part.to_vec()),
                None => {
                    let head = inflated(part, MAX_HEAD)?;
                    self.head = Some(postcard::from_bytes(&head).map_err(|_| BadCheckpoint)?);
                }
            }
        }
        self.rest.drain(..used);
        if self.blocks.len() >= AT_ONCE { self.read_blocks() } else { Ok(()) }
    }

    fn read_blocks(&mut self) -> Result<(), BadCheckpoint> {
        let read: Vec<_> = self.blocks.par_iter().map(|b| pages_of(b)).collect();
        self.blocks.clear();
        for pages in read {
            self.pages.extend(pages?);
        }
        Ok(())
    }

    /// The world again, after all bytes.
    ///
    /// # Errors
    /// [`BadCheckpoint`]
    pub fn finish(mut self, workers: Workers) -> Result<World, BadCheckpoint> {
        self.read_blocks()?;
        let head = self.head.filter(|_| self.rest.is_empty()).ok_or(BadCheckpoint)?;
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
        let mut pages = self.pages.into_iter();
        let mut clays = Vec::new();
        for (i, (rest, object)) in rests.iter().zip(head.objects).enumerate() {
            let own: Vec<Arc<Page>> = pages.by_ref().take(object.pages as usize).collect();
            let mut clay = Clay::of_stored(own, rest).map_err(|_| BadCheckpoint)?;
            clay.set_empty(rest.empty.clone());
            match i == active {
                true => saved.levels = object.levels,
                false => clay.set_levels(object.levels),
            }
            clays.push(clay);
        }
        if pages.next().is_some() {
            return Err(BadCheckpoint);
        }
        let options = WorldOptions { dab_budget, undo_bytes, hands };
        World::restore(clays, saved, workers, options).map_err(|_| BadCheckpoint)
    }
}

/// The world of all bytes in a row.
///
/// # Errors
/// [`BadCheckpoint`]
pub fn restore(bytes: &[u8], workers: Workers) -> Result<World, BadCheckpoint> {
    let mut restoring = Restoring::default();
    restoring.take(bytes)?;
    restoring.finish(workers)
}

/// Appends a part: its length, then its bytes.
fn put_part(out: &mut Vec<u8>, part: &[u8]) {
    out.extend_from_slice(&(part.len() as u32).to_le_bytes());
    out.extend_from_slice(part);
}

/// Some pages, compressed.
fn block_of(pages: &[&Arc<Page>]) -> Vec<u8> {
    let mut part = Vec::new();
    pages.iter().for_each(|page| page.put_planes(&mut part));
    compressed(&part)
}

/// The pages of one block.
fn pages_of(block: &[u8]) -> Result<Vec<Arc<Page>>, BadCheckpoint> {
    let bytes = inflated(block, MAX_PAGE * BLOCK as u64)?;
    let mut rest = &bytes[..];
    let mut pages = Vec::with_capacity(BLOCK);
    while !rest.is_empty() {
        let (page, after) = Page::take_planes(rest).map_err(|_| BadCheckpoint)?;
        pages.push(Arc::new(page));
        rest = after;
    }
    Ok(pages)
}

fn compressed(bytes: &[u8]) -> Vec<u8> {
    // Writing to memory cannot fail.
    zstd::bulk::compress(bytes, LEVEL).unwrap_or_default()
}

/// Memory grows with the bytes received, not with the announced size.
fn inflated(bytes: &[u8], most: u64) -> Result<Vec<u8>, BadCheckpoint> {
    let mut out = Vec::new();
    let from = zstd::stream::read::Decoder::with_buffer(bytes).map_err(|_| BadCheckpoint)?;
    from.take(most).read_to_end(&mut out).map_err(|_| BadCheckpoint)?;
    Ok(out)
}
