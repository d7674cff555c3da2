//! What a page is sent next: pages of clay that changed first, then those it has never had, the
//! ones in front and near before the others; never more than it has room for.

use std::collections::{BTreeMap, VecDeque};
use std::sync::Arc;

use glam::{Mat4, Vec3};

use super::page_code::{self, Names, SentPage};
use super::walls::SentWalls;
use crate::Published;
use sculptd_clay::Snapshot;
use sculptd_clay::brush::BrushSettings;
use sculptd_clay::page::Page;
use sculptd_engine::camera::Camera;
use sculptd_engine::scene::ObjectId;

/// Bytes that may be on the way to a page: 100 Mbit/s at a delay of 80 ms.
const WINDOW: usize = 1 << 20;

/// The pictures of one page in a browser.
#[derive(Debug, Default)]
pub struct Delivery {
    objects: BTreeMap<ObjectId, ObjectPages>,
    /// Messages that the page has not acknowledged, the oldest first.
    on_the_way: VecDeque<OnTheWay>,
    bytes_on_the_way: usize,
    last_message: u32,
    /// The map of walls, where the page shows it.
    pub walls: SentWalls,
    /// Bytes of pages that were sent.
    pub sent_bytes: u64,
    /// View and brush of a guest who was cut off.
    pub settings: Option<(Camera, BrushSettings)>,
}

#[derive(Debug, Clone, Copy)]
struct OnTheWay {
    message: u32,
    bytes: usize,
    object: ObjectId,
    page: u32,
}

/// The page of a message that carries no clay.
const NO_PAGE: u32 = u32::MAX;

/// What a message says of a page.
enum WrittenPage {
    Nothing,
    Rows,
    Whole,
}

/// The pages of one object.
#[derive(Debug)]
struct ObjectPages {
    clay: Snapshot,
    sent: Vec<Option<SentPage>>,
    /// Pages that changed since they were sent.
    changed: VecDeque<u32>,
    /// Pages that were never sent, the most important last.
    unseen: Vec<u32>,
    /// Pages in either queue.
    queued: Vec<bool>,
    /// There may be pages that were never sent and are in no queue.
    grown: bool,
}

/// An object as its page in the browser lists it.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct ShownObject {
    pub id: u32,
    pub name: String,
    pub active: bool,
    /// Of the object to the world, column by column.
    pub matrix: [f32; 16],
    /// Pages of its clay: the browser forgets those beyond.
    pub pages: u32,
    pub vertices: u64,
    pub triangles: u64,
    /// Number of its clay: with another one, all pages are others.
    pub clay: u32,
}

impl Delivery {
    /// Looks at the newest state. `camera`: the view that the page has.
    pub fn look(&mut self, state: &Published, camera: &Camera) {
        let shown = |o: &&sculptd_engine::scene::ObjectView| o.settings.visible;
        let visible = |id: &ObjectId| state.scene.object(*id).filter(shown).is_some();
        self.objects.retain(|id, _| visible(id));
        for (object, clay) in state.scene.each(&state.mesh).filter(|(o, _)| o.settings.visible) {
            let known = self.objects.get_mut(&object.id);
            match known.filter(|k| k.clay.object_id() == clay.object_id()) {
                Some(known) => known.follow(clay),
                None => {
                    let pages = ObjectPages::new(clay);
                    self.objects.insert(object.id, pages);
                }
            }
        }
        for (id, pages) in &mut self.objects {
            if std::mem::take(&mut pages.grown) {
                let to_world = state.scene.object(*id).map(|o| o.settings.transform);
                let place = |p: Vec3| to_world.map_or(p, |t| t.point(p));
                let turned = |n: Vec3| to_world.map_or(n, |t| t.direction(n));
                pages.order(camera, place, turned);
            }
        }
    }

    /// Appends the next message to `out`, which is emptied first. Returns false if there is none,
    /// or no room for it.
    pub fn next(&mut self, out: &mut Vec<u8>) -> bool {
        out.clear();
        while self.bytes_on_the_way < WINDOW {
            let message = self.last_message + 1;
            let (object, page) = match self.next_page() {
                Some((object, page)) => {
                    let names = Names { message, object: object.0, page };
                    let written = self.objects.get_mut(&object).map(|o| o.write(page, names, out));
                    match written {
                        Some(WrittenPage::Whole) => self.walls.forget(object, page),
                        Some(WrittenPage::Rows) => {}
                        Some(WrittenPage::Nothing) | None => {
                            out.clear();
                            continue;
                        }
                    }
                    (object, page)
                }
                // Walls come after their clay.
                None => {
                    let Some((object, page, values)) = self.next_walls() else { return false };
                    page_code::values(&values, Names { message, object: object.0, page }, out);
                    (object, NO_PAGE)
                }
            };
            self.last_message = message;
            self.on_the_way.push_back(OnTheWay { message, bytes: out.len(), object, page });
            self.bytes_on_the_way += out.len();
            self.sent_bytes += out.len() as u64;
            return true;
        }
        false
    }

    fn next_walls(&mut self) -> Option<(ObjectId, u32, Arc<[f32]>)> {
        let objects = &self.objects;
        self.walls.next(|object, clay, page| {
            let known = objects.get(&object).filter(|o| o.clay.object_id() == clay)?;
            Some(known.sent.get(page as usize)?.as_ref()?.rows())
        })
    }

    fn next_page(&mut self) -> Option<(ObjectId, u32)> {
        let changed = self.objects.iter_mut().find_map(|(id, o)| Some((*id, o.next_changed()?)));
        changed
            .or_else(|| self.objects.iter_mut().find_map(|(id, o)| Some((*id, o.next_unseen()?))))
    }

    /// The page has received this message and all before it.
    pub fn acknowledge(&mut self, message: u32) {
        while self.on_the_way.front().is_some_and(|m| m.message <= message) {
            let bytes = self.on_the_way.pop_front().map_or(0, |m| m.bytes);
            self.bytes_on_the_way = self.bytes_on_the_way.saturating_sub(bytes);
        }
    }

    /// The page is back after a cut and has received everything up to this message: what was on the
    /// way is sent again.
    pub fn resume(&mut self, message: u32) {
        self.acknowledge(message);
        for lost in std::mem::take(&mut self.on_the_way) {
            if let Some(object) = self.objects.get_mut(&lost.object) {
                object.forget(lost.page);
            }
        }
        self.bytes_on_the_way = 0;
        self.walls.clear();
    }

    /// Returns true if every page is as the newest state has it, and acknowledged.
    pub fn is_complete(&self) -> bool {
        let waits = |o: &ObjectPages| !(o.changed.is_empty() && o.unseen.is_empty());
        self.on_the_way.is_empty() && !self.objects.values().any(waits)
    }

    /// Returns true if something waits and there is room for it.
    pub fn can_send(&self) -> bool {
        let waits = |o: &ObjectPages| !(o.changed.is_empty() && o.unseen.is_empty());
        let has_more = self.walls.wait() || self.objects.values().any(waits);
        self.bytes_on_the_way < WINDOW && has_more
    }
}

/// Lists the visible objects.
pub fn shown_objects(state: &Published) -> Vec<ShownObject> {
    let active = state.scene.active().map(|o| o.id);
    let all = state.scene.each(&state.mesh).filter(|(o, _)| o.settings.visible);
    all.map(|(o, clay)| {
        let t = &o.settings.transform;
        let scale = Vec3::splat(t.scale as f32);
        let matrix =
            Mat4::from_scale_rotation_translation(scale, t.turn.as_quat(), t.shift.as_vec3());
        ShownObject {
            id: o.id.0,
            name: o.settings.name.clone(),
            active: Some(o.id) == active,
            matrix: matrix.to_cols_array(),
            pages: clay.page_count() as u32,
            vertices: clay.vertex_count() as u64,
            triangles: clay.triangle_count() as u64,
            clay: clay.object_id(),
        }
    })
    .collect()
}

impl ObjectPages {
    fn new(clay: &Snapshot) -> ObjectPages {
        let count = clay.page_count();
        ObjectPages {
            clay: clay.clone(),
            sent: vec![None; count],
            changed: VecDeque::new(),
            unseen: Vec::new(),
            queued: vec![false; count],
            grown: true,
        }
    }

    fn follow(&mut self, clay: &Snapshot) {
        let count = clay.page_count();
        if count < self.sent.len() {
            self.changed.retain(|p| (*p as usize) < count);
            self.unseen.retain(|p| (*p as usize) < count);
        }
        self.grown |= count > self.sent.len();
        self.sent.resize(count, None);
        self.queued.resize(count, false);
        let ObjectPages { sent, changed, queued, .. } = self;
        clay.each_changed(&self.clay, |page, _| {
            let at = page as usize;
            if sent[at].is_some() && !std::mem::replace(&mut queued[at], true) {
                changed.push_back(page);
            }
        });
        self.clay = clay.clone();
    }

    /// Puts the pages that were never sent in order: in front before behind, near before far.
    fn order(
        &mut self,
        camera: &Camera,
        place: impl Fn(Vec3) -> Vec3,
        turned: impl Fn(Vec3) -> Vec3,
    ) {
        let eye = camera.eye();
        let weight = |page: &Arc<Page>| {
            let (lo, hi) = page.bounds();
            let middle = place((lo + hi) / 2.0);
            let to_eye = eye - middle;
            let normal = (page.own() > 0).then(|| turned(page.normal(page.own() / 2)));
            let behind = normal.is_some_and(|n| n.dot(to_eye) < 0.0);
            let aside = !camera.project(middle).is_some_and(|v| {
                v.cmpge(glam::Vec2::splat(-0.1)).all() && v.cmple(glam::Vec2::splat(1.1)).all()
            });
            (behind || aside, to_eye.length())
        };
        let mut all: Vec<(bool, f32, u32)> = Vec::new();
        for (page, sent) in (0..).zip(&self.sent) {
            if sent.is_none() {
                let (last, far) = weight(self.clay.page(page));
                all.push((last, far, page));
                self.queued[page as usize] = true;
            }
        }
        all.sort_by(|a, b| {
            (b.0, b.1).partial_cmp(&(a.0, a.1)).unwrap_or(std::cmp::Ordering::Equal)
        });
        self.unseen = all.into_iter().map(|(.., page)| page).collect();
    }

    fn next_changed(&mut self) -> Option<u32> {
        let page = self.changed.pop_front()?;
        self.queued[page as usize] = false;
        Some(page)
    }

    fn next_unseen(&mut self) -> Option<u32> {
        let page = self.unseen.pop()?;
        self.queued[page as usize] = false;
        Some(page)
    }

    /// Appends a page to `out`, unless the browser has it as it is.
    fn write(&mut self, page: u32, names: Names, out: &mut Vec<u8>) -> WrittenPage {
        let Some(slot) = self.sent.get_mut(page as usize) else { return WrittenPage::Nothing };
        let now = self.clay.page(page);
        if let Some(sent) = slot {
            if sent.is(now) {
                return WrittenPage::Nothing;
            }
            if page_code::changed(sent, now, names, out) {
                let none = out.len() <= page_code::HEAD;
                return if none { WrittenPage::Nothing } else { WrittenPage::Rows };
            }
        }
        *slot = Some(page_code::write_page(now, names, out));
        WrittenPage::Whole
    }

    /// The browser may not have this page.
    fn forget(&mut self, page: u32) {
        let at = page as usize;
        if at < self.sent.len() {
            self.sent[at] = None;
            if !std::mem::replace(&mut self.queued[at], true) {
                self.unseen.push(page);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::published::PublishedFigures;
    use sculptd_clay::{Clay, Workers};
    use sculptd_engine::world::{World, WorldOptions};
    use sculptd_geometry::job::Job;
    use sculptd_geometry::shapes;

    fn state(parts: u32) -> Published {
        let mesh = shapes::icosphere(1.0, parts);
        let clay = Clay::build(&mesh, &Job::default()).expect("clay");
        let options =
            WorldOptions { dab_budget: 1 << 20, undo_bytes: 1 << 20, hands: Default::default() };
        let (camera, brush) = (Camera::default(), BrushSettings::default());
        let mut world = World::new(clay, camera, brush, Workers::new(1), options);
        Published::of(&mut world, PublishedFigures::default())
    }

    fn page_of(message: &[u8]) -> u32 {
        u32::from_le_bytes([message[12], message[13], message[14], message[15]])
    }

    #[test]
    fn the_front_comes_first_and_everything_comes_once() {
        let state = state(64);
        let mut delivery = Delivery::default();
        delivery.look(&state, &state.camera);
        let (mut seen, mut out) = (Vec::new(), Vec::new());
        while delivery.next(&mut out) {
            seen.push(page_of(&out));
            delivery.acknowledge(seen.len() as u32);
        }
        assert!(delivery.is_complete());
        let mut each = seen.clone();
        each.sort_unstable();
        assert!(each.iter().copied().eq(0..state.mesh.page_count() as u32));
        let front = |page: &&u32| {
            let page = state.mesh.page(**page);
            page.normal(page.own() / 2).dot(state.camera.backward()) > 0.0
        };
        let (early, late) = seen.split_at(seen.len() / 3);
        assert_eq!(early.iter().filter(front).count(), early.len());
        let front_late = late.iter().filter(front).count();
        assert!(front_late < late.len() / 2, "{front_late} of {}", late.len());
        delivery.look(&state, &state.camera);
        assert!(!delivery.next(&mut out), "nothing changed");
    }

    #[test]
    fn a_page_that_acknowledges_nothing_is_sent_a_window_and_no_more() {
        let state = state(128);
        let mut delivery = Delivery::default();
        delivery.look(&state, &state.camera);
        let (mut bytes, mut out, mut messages) = (0, Vec::new(), 0);
        while delivery.next(&mut out) {
            (bytes, messages) = (bytes + out.len(), messages + 1);
        }
        assert!((WINDOW..WINDOW + (64 << 10)).contains(&bytes), "{bytes}");
        assert!(!delivery.can_send() && !delivery.is_complete());
        // After a cut the page had received half: the other half comes again, and the rest.
        delivery.resume(messages / 2);
        let mut again = 0;
        while delivery.next(&mut out) {
            again += 1;
            delivery.acknowledge(messages + again);
        }
        assert_eq!(messages / 2 + again, state.mesh.page_count() as u32);
        assert!(delivery.is_complete());
    }
}
