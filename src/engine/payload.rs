//! Payloads: data that a command needs besides its fields, because making it takes too long for the
//! thread that steps the world.
//!
//! A [`Command`](crate::command::Command) is plain data and names its payload by a [`PayloadId`];
//! the [`PayloadStore`] beside the world keeps the payload itself. The sender of a command builds
//! or fetches its payload first and sends both. The owner of the world puts the payload into the
//! store with [`World::deliver`](crate::world::World::deliver) before the step that reads the
//! command. A command that was read from a session has no payload: the world rebuilds clay from the
//! triangles that the command holds, and a replay fetches the pages of a jump from the session
//! file.

use std::sync::Arc;

use sculptd_clay::{Clay, GarbageSink, Page};

/// Data that a command needs besides its fields.
#[derive(Debug)]
pub enum Payload {
    /// The clay of a new object, or of another object that a jump leads to.
    Clay(Box<Clay>),
    /// The pages that a jump puts in place, each with its number.
    Pages(Vec<(u32, Arc<Page>)>),
    /// The clays of new objects, or of all objects that a jump leads to, in their order.
    Clays(Vec<Clay>),
}

/// Names a payload in the store of one world.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PayloadId {
    /// By a number that the store has given out.
    Number(u64),
    /// By what a jump says of itself, so that a jump that was read from a file names its payload
    /// too: the history node that it leads to, and the object and revision that it starts from.
    Jump {
        /// The history node that the jump leads to.
        node: u64,
        /// The object and its revision when the jump was made.
        from: (u32, u64),
    },
}

/// The payloads of the commands of the next step. At the end of a step the store is empty.
#[derive(Debug)]
pub struct PayloadStore {
    entries: Vec<(PayloadId, Payload)>,
    next: u64,
}

impl PayloadStore {
    /// Payloads that the store holds at most: as many as a tick takes commands.
    pub const CAPACITY: usize = 64;

    pub(crate) fn new() -> Self {
        PayloadStore { entries: Vec::with_capacity(Self::CAPACITY), next: 0 }
    }

    /// A number that no payload of this store has had.
    pub fn number(&mut self) -> PayloadId {
        self.next += 1;
        PayloadId::Number(self.next)
    }

    /// Keeps the payload until the end of the next step. A payload of the same name is replaced.
    ///
    /// # Errors
    /// Gives a payload back that is not kept: the replaced one, or this one when the store is full.
    pub fn insert(&mut self, id: PayloadId, payload: Payload) -> Result<(), Payload> {
        let replaced = self.take(id);
        if self.entries.len() == Self::CAPACITY {
            return Err(payload);
        }
        self.entries.push((id, payload));
        replaced.map_or(Ok(()), Err)
    }

    /// The payload of this name, which then is no longer in the store.
    pub fn take(&mut self, id: PayloadId) -> Option<Payload> {
        let at = self.entries.iter().position(|(name, _)| *name == id)?;
        Some(self.entries.swap_remove(at).1)
    }

    /// Returns the number of payloads in the store.
    pub fn len(&self) -> usize {
        self.entries.len()
    }

    /// Returns true if the store has no payload.
    pub fn is_empty(&self) -> bool {
        self.entries.is_empty()
    }

    /// Hands over what no command has taken.
    pub(crate) fn clear(&mut self, sink: &GarbageSink) {
        self.entries.drain(..).for_each(|(_, payload)| sink.discard_owned(payload));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_store_is_bounded_and_gives_back_what_it_does_not_keep() {
        let mut store = PayloadStore::new();
        let ids: Vec<_> = (0..PayloadStore::CAPACITY).map(|_| store.number()).collect();
        for (k, id) in ids.iter().enumerate() {
            let page = (k as u32, Arc::new(Page::nothing()));
            assert!(store.insert(*id, Payload::Pages(vec![page])).is_ok());
        }
        let id = store.number();
        assert!(store.insert(id, Payload::Pages(Vec::new())).is_err(), "65 payloads");
        assert!(store.take(id).is_none());
        // Another payload of a name that is there takes the place of the first.
        let back = store.insert(ids[3], Payload::Pages(Vec::new()));
        assert!(matches!(back, Err(Payload::Pages(p)) if p[0].0 == 3));
        assert!(matches!(store.take(ids[3]), Some(Payload::Pages(p)) if p.is_empty()));
        assert!(matches!(store.take(ids[63]), Some(Payload::Pages(p)) if p[0].0 == 63));
        assert_eq!(store.len(), PayloadStore::CAPACITY - 2);
        store.clear(&GarbageSink::default());
        assert!(store.is_empty());
    }
}
