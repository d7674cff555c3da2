//! The history's tables: nodes, pages, checkpoints, pictures. Every row carries the checksum of its
//! bytes and, where the bytes are a struct's, the layout that they were written in: rows of an
//! older layout are decoded as it had them, see [`crate::session::format`].

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use rusqlite::{Connection, OptionalExtension};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use super::page_name::NOTHING;
pub use super::page_name::Name;
use super::tree::{Node, Tree};
use crate::session::format::{field_counts, v3};
use crate::session::{VERSION, connection};
use sculptd_clay::brush::Picture;
use sculptd_clay::page::PageTopology;
use sculptd_clay::{Levels, ObjectState, Page};
use sculptd_engine::old_layout::take_from_bytes;
use sculptd_engine::world::{Saved, SideData};
use sculptd_geometry::TriMesh;

/// Added to a session's tables; a session from before them has none and is replayed.
pub const TABLES: &str = "
    CREATE TABLE IF NOT EXISTS node (
        id INTEGER PRIMARY KEY,
        crc INTEGER NOT NULL,
        data BLOB NOT NULL,
        layout INTEGER NOT NULL DEFAULT 3
    );
    CREATE TABLE IF NOT EXISTS page (
        lineage INTEGER NOT NULL,
        number INTEGER NOT NULL,
        revision INTEGER NOT NULL,
        topology INTEGER NOT NULL,
        crc INTEGER NOT NULL,
        data BLOB NOT NULL
    );
    CREATE UNIQUE INDEX IF NOT EXISTS page_name ON page (lineage, number, revision, topology);
    CREATE TABLE IF NOT EXISTS topology (
        lineage INTEGER NOT NULL,
        number INTEGER NOT NULL,
        revision INTEGER NOT NULL,
        crc INTEGER NOT NULL,
        data BLOB NOT NULL,
        PRIMARY KEY (lineage, number, revision)
    );
    CREATE TABLE IF NOT EXISTS side (
        id INTEGER PRIMARY KEY,
        crc INTEGER NOT NULL,
        data BLOB NOT NULL,
        layout INTEGER NOT NULL DEFAULT 3
    );
    CREATE TABLE IF NOT EXISTS checkpoint (
        id INTEGER PRIMARY KEY,
        tick INTEGER NOT NULL,
        crc INTEGER NOT NULL,
        data BLOB NOT NULL,
        layout INTEGER NOT NULL DEFAULT 3
    );
    CREATE TABLE IF NOT EXISTS proof (
        checkpoint INTEGER PRIMARY KEY,
        crc INTEGER NOT NULL,
        hash INTEGER NOT NULL
    );
    CREATE TABLE IF NOT EXISTS sight (node INTEGER PRIMARY KEY, png BLOB NOT NULL);
    CREATE TABLE IF NOT EXISTS pin (
        id INTEGER PRIMARY KEY,
        tick INTEGER NOT NULL,
        data BLOB NOT NULL,
        layout INTEGER NOT NULL DEFAULT 3
    );
    CREATE TABLE IF NOT EXISTS high (
        lineage INTEGER PRIMARY KEY,
        revision INTEGER NOT NULL,
        vertex INTEGER NOT NULL,
        triangle INTEGER NOT NULL
    );
";

#[derive(Debug, thiserror::Error)]
pub enum StoreError {
    #[error("the session file: {0}")]
    Sql(#[from] rusqlite::Error),
    #[error("the session file: {0} is damaged or missing")]
    Damaged(String),
}

/// A state of the world, as stored in the file.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Checkpoint {
    pub tick: u64,
    pub node: u64,
    pub rest: ObjectState,
    pub core: Vec<u8>,
    /// The sides: held object, picture, levels.
    pub sides: [Option<u64>; 3],
    pub steps: (u32, u32),
    /// The layout of `core`, stored in a separate column.
    #[serde(skip)]
    pub layout: u32,
    /// The hash of the live sculpture, [`SceneView::page_hash`], stored in a separate table. `None`
    /// in files written by earlier versions.
    ///
    /// [`SceneView::page_hash`]: sculptd_engine::scene::SceneView::page_hash
    #[serde(skip)]
    pub proof: Option<u64>,
}

/// One row's checksum, bytes and layout.
struct StoredRow {
    crc: u32,
    data: Vec<u8>,
    layout: u32,
}

impl StoredRow {
    /// Decodes the value; `None` if the bytes have changed.
    fn decode<T: DeserializeOwned>(&self) -> Option<T> {
        self.decode_with_rest().map(|(value, _)| value)
    }

    /// Decodes the value, and returns the bytes after it.
    fn decode_with_rest<T: DeserializeOwned>(&self) -> Option<(T, &[u8])> {
        let counts = field_counts(self.layout)?;
        if crc32fast::hash(&self.data) != self.crc {
            return None;
        }
        take_from_bytes(&self.data, counts).ok()
    }

    /// A node, and the list of objects behind it, where there is one.
    fn decode_node(&self) -> Option<Node> {
        let (node, rest) = self.decode_with_rest::<Node>()?;
        let scene = match rest {
            [] => None,
            rest => Some(Arc::new(postcard::from_bytes(rest).ok()?)),
        };
        Some(Node { scene, ..node })
    }
}

/// The tables, through a connection of their own.
#[derive(Debug)]
pub struct Store {
    pub(in crate::session) db: Connection,
    /// The SQL that gives a row's layout: a file of layout 3 has no column for it.
    layout: &'static str,
}

pub(super) fn encoded(bytes: Result<Vec<u8>, postcard::Error>) -> Result<Vec<u8>, StoreError> {
    bytes.map_err(|e| StoreError::Sql(rusqlite::Error::ToSqlConversionFailure(Box::new(e))))
}

impl Store {
    /// For reading; changes nothing.
    pub fn read(path: &Path) -> Result<Store, StoreError> {
        let db = connection::connect(path, false)?;
        let found: u32 = db.query_row("PRAGMA user_version", [], |r| r.get(0))?;
        Ok(Store { db, layout: if found == v3::LAYOUT { "3" } else { "layout" } })
    }

    /// For the keeper: synced by the session's own thread, see `syncer`.
    pub fn write(path: &Path) -> Result<Store, StoreError> {
        let db = Connection::open(path)?;
        db.busy_timeout(std::time::Duration::from_secs(2))?;
        db.pragma_update(None, "wal_autocheckpoint", 0)?;
        connection::commit_without_waiting(&db)?;
        db.execute_batch(TABLES)?;
        Ok(Store { db, layout: "layout" })
    }

    /// Gives the room of what went back to the disk. Takes as long as the file is large.
    pub fn compact(&self) -> Result<(), StoreError> {
        self.db.pragma_update(None, "synchronous", "full")?;
        self.db.execute_batch("VACUUM; PRAGMA wal_checkpoint(TRUNCATE)")?;
        Ok(())
    }

    /// Returns true if the file contains a history.
    ///
    /// # Errors
    /// Returns an error if the schema cannot be read.
    pub fn has_tables(&self) -> Result<bool, StoreError> {
        self.has_table("node")
    }

    fn has_table(&self, name: &str) -> Result<bool, StoreError> {
        let sql = "SELECT count(*) FROM sqlite_schema WHERE name = ?1";
        Ok(self.db.query_row(sql, [name], |r| r.get::<_, i64>(0))? > 0)
    }

    /// Every node whose parents are there too. A damaged one ends its branch.
    pub fn tree(&self) -> Result<Tree, StoreError> {
        let mut tree = Tree::default();
        let sql = format!("SELECT crc, data, {} FROM node ORDER BY id", self.layout);
        let mut query = self.db.prepare(&sql)?;
        let mut rows = query.query([])?;
        while let Some(row) = rows.next()? {
            let row = StoredRow { crc: row.get(0)?, data: row.get(1)?, layout: row.get(2)? };
            if let Some(node) = row.decode_node()
                && node.parent.is_none_or(|p| tree.node(p).is_some())
            {
                tree.cursor = node.id;
                tree.add(node);
            }
        }
        Ok(tree)
    }

    fn row(&self, table: &str, id: u64) -> Result<StoredRow, StoreError> {
        let sql = format!("SELECT crc, data, {} FROM {table} WHERE id = ?1", self.layout);
        let row = self.db.query_row(&sql, [id as i64], |r| {
            Ok(StoredRow { crc: r.get(0)?, data: r.get(1)?, layout: r.get(2)? })
        });
        row.optional()?.ok_or_else(|| StoreError::Damaged(format!("{table} {id}")))
    }

    /// Reads every row and returns a description of the damage: the number of bad rows of each
    /// table, or the table that cannot be read completely.
    ///
    /// # Errors
    /// Returns an error if nothing can be read.
    pub fn check(&self) -> Result<Option<String>, StoreError> {
        if !self.has_tables()? {
            return Ok(None);
        }
        let mut found = Vec::new();
        for table in ["node", "page", "topology", "side", "checkpoint"] {
            let mut bad = 0;
            let mut read = || -> rusqlite::Result<()> {
                let mut query = self.db.prepare(&format!("SELECT crc, data FROM {table}"))?;
                let mut rows = query.query([])?;
                while let Some(row) = rows.next()? {
                    let (crc, data) = (row.get::<_, u32>(0)?, row.get_ref(1)?);
                    bad += u64::from(data.as_blob().map(crc32fast::hash) != Ok(crc));
                }
                Ok(())
            };
            match read() {
                Err(e) => found.push(format!("{table}: {e}")),
                Ok(()) if bad > 0 => found.push(format!("{table}: {bad} rows")),
                Ok(()) => {}
            }
        }
        Ok(Some(found.join(", ")).filter(|text| !text.is_empty()))
    }

    /// The checkpoints at or before a tick, the newest first.
    pub fn checkpoints(&self, until: u64) -> Result<Vec<u64>, StoreError> {
        let mut query = self
            .db
            .prepare("SELECT id FROM checkpoint WHERE tick <= ?1 ORDER BY tick DESC, id DESC")?;
        let until = i64::try_from(until).unwrap_or(i64::MAX);
        let all = query.query_map([until], |r| r.get::<_, i64>(0))?;
        all.map(|id| Ok(id? as u64)).collect()
    }

    pub fn checkpoint(&self, id: u64) -> Result<Checkpoint, StoreError> {
        let row = self.row("checkpoint", id)?;
        let (layout, made) = (row.layout, row.decode::<Checkpoint>());
        let made = made.ok_or_else(|| StoreError::Damaged("a checkpoint".into()))?;
        Ok(Checkpoint { layout, proof: self.proof(id, row.crc)?, ..made })
    }

    /// Returns the proof of a checkpoint whose bytes have the checksum `crc`: one that was written
    /// for other bytes does not count.
    fn proof(&self, id: u64, crc: u32) -> Result<Option<u64>, StoreError> {
        if !self.has_table("proof")? {
            return Ok(None);
        }
        let sql = "SELECT hash FROM proof WHERE checkpoint = ?1 AND crc = ?2";
        let found = self.db.query_row(sql, (id as i64, crc), |r| r.get::<_, i64>(0)).optional()?;
        Ok(found.map(|hash| hash as u64))
    }

    /// The state of a checkpoint, with its sides.
    pub fn saved(&self, c: Checkpoint) -> Result<Saved, StoreError> {
        let [thing, picture, levels] = c.sides;
        Ok(Saved {
            tick: c.tick,
            rest: c.rest,
            core: c.core,
            thing: thing.map(|id| self.side::<TriMesh>(id)).transpose()?.map(Arc::new),
            picture: picture.map(|id| self.side::<Picture>(id)).transpose()?.map(Arc::new),
            levels: levels.map(|id| self.side::<Levels>(id)).transpose()?.map(Arc::new),
            steps: c.steps,
            field_counts: field_counts(c.layout)
                .ok_or_else(|| StoreError::Damaged("the layout of a checkpoint".into()))?,
        })
    }

    pub fn side<T: DeserializeOwned>(&self, id: u64) -> Result<T, StoreError> {
        let made = self.row("side", id)?.decode();
        made.ok_or_else(|| StoreError::Damaged("a thing beside the object".into()))
    }

    pub fn put_side(&self, id: u64, side: &SideData) -> Result<usize, StoreError> {
        let data = encoded(match side {
            SideData::HeldObject(t) => postcard::to_stdvec(t.as_ref()),
            SideData::Picture(p) => postcard::to_stdvec(p.as_ref()),
            SideData::Levels(l) => postcard::to_stdvec(l.as_ref()),
        })?;
        let row = (id as i64, crc32fast::hash(&data), &data, VERSION);
        self.db.execute(
            "INSERT OR REPLACE INTO side (id, crc, data, layout) VALUES (?1, ?2, ?3, ?4)",
            row,
        )?;
        Ok(data.len())
    }

    pub fn next_side(&self) -> Result<u64, StoreError> {
        let last: Option<i64> = self.db.query_row("SELECT max(id) FROM side", [], |r| r.get(0))?;
        Ok(last.map_or(0, |l| l as u64 + 1))
    }

    pub fn put_node(&self, node: &Node) -> Result<usize, StoreError> {
        let mut data = encoded(postcard::to_stdvec(node))?;
        if let Some(scene) = &node.scene {
            data = encoded(postcard::to_extend(scene.as_ref(), data))?;
        }
        let row = (node.id as i64, crc32fast::hash(&data), &data, VERSION);
        self.db.execute(
            "INSERT OR REPLACE INTO node (id, crc, data, layout) VALUES (?1, ?2, ?3, ?4)",
            row,
        )?;
        Ok(data.len())
    }

    pub fn put_sight(&self, node: u64, png: &[u8]) -> Result<usize, StoreError> {
        self.db.execute(
            "INSERT OR REPLACE INTO sight (node, png) VALUES (?1, ?2)",
            (node as i64, png),
        )?;
        Ok(png.len())
    }

    /// The small picture of a node, PNG.
    pub fn thumbnail(&self, node: u64) -> Result<Option<Vec<u8>>, StoreError> {
        let found = self
            .db
            .query_row("SELECT png FROM sight WHERE node = ?1", [node as i64], |r| r.get(0))
            .optional();
        Ok(found?)
    }

    /// The small picture of the newest node that has one, PNG.
    pub fn newest_thumbnail(&self) -> Result<Option<Vec<u8>>, StoreError> {
        let sql = "SELECT png FROM sight ORDER BY node DESC LIMIT 1";
        Ok(self.db.query_row(sql, [], |r| r.get(0)).optional()?)
    }

    pub fn put_checkpoint(&self, c: &Checkpoint) -> Result<usize, StoreError> {
        let data = encoded(postcard::to_stdvec(c))?;
        let row = (c.tick as i64, crc32fast::hash(&data), &data, VERSION);
        self.db.execute(
            "INSERT INTO checkpoint (tick, crc, data, layout) VALUES (?1, ?2, ?3, ?4)",
            row,
        )?;
        if let Some(hash) = c.proof {
            let row = (self.db.last_insert_rowid(), crc32fast::hash(&data), hash as i64);
            let sql = "INSERT OR REPLACE INTO proof (checkpoint, crc, hash) VALUES (?1, ?2, ?3)";
            self.db.execute(sql, row)?;
        }
        Ok(data.len())
    }

    /// The versions of pages that are stored, with the revision of the topology of each.
    pub fn names(&self) -> Result<BTreeMap<Name, u64>, StoreError> {
        let mut query = self.db.prepare("SELECT lineage, number, revision, topology FROM page")?;
        let rows = query.query_map([], |r| {
            let name = (r.get(0)?, r.get(1)?, r.get::<_, i64>(2)? as u64);
            Ok((name, r.get::<_, i64>(3)? as u64))
        })?;
        rows.map(|r| Ok(r?)).collect()
    }

    /// The topologies that are stored.
    pub fn topologies(&self) -> Result<std::collections::BTreeSet<Name>, StoreError> {
        let mut query = self.db.prepare("SELECT lineage, number, revision FROM topology")?;
        let rows =
            query.query_map([], |r| Ok((r.get(0)?, r.get(1)?, r.get::<_, i64>(2)? as u64)))?;
        rows.map(|r| Ok(r?)).collect()
    }

    pub fn put_page(&self, name: Name, topology: u64, page: &Page) -> Result<usize, StoreError> {
        let data = page.to_bytes();
        let mut put = self.db.prepare_cached(
            "INSERT OR IGNORE INTO page (lineage, number, revision, topology, crc, data)
             VALUES (?1, ?2, ?3, ?4, ?5, ?6)",
        )?;
        put.execute((
            name.0,
            name.1,
            name.2 as i64,
            topology as i64,
            crc32fast::hash(&data),
            &data,
        ))?;
        Ok(data.len())
    }

    pub fn put_topology(&self, name: Name, topology: &PageTopology) -> Result<usize, StoreError> {
        let data = topology.to_bytes();
        let mut put = self.db.prepare_cached(
            "INSERT OR IGNORE INTO topology (lineage, number, revision, crc, data) VALUES (?1, ?2, \
                ?3, ?4, ?5)",
        )?;
        put.execute((name.0, name.1, name.2 as i64, crc32fast::hash(&data), &data))?;
        Ok(data.len())
    }

    fn topology(&self, name: Name) -> Result<Arc<PageTopology>, StoreError> {
        let damaged = || StoreError::Damaged(format!("the topology of page {}", name.1));
        let row: Option<(u32, Vec<u8>)> = self
            .db
            .prepare_cached(
                "SELECT crc, data FROM topology WHERE lineage = ?1 AND number = ?2 AND revision = \
                    ?3",
            )?
            .query_row((name.0, name.1, name.2 as i64), |r| Ok((r.get(0)?, r.get(1)?)))
            .optional()?;
        let (crc, data) = row.ok_or_else(damaged)?;
        if crc32fast::hash(&data) != crc {
            return Err(damaged());
        }
        Ok(Arc::new(PageTopology::from_bytes(&data).map_err(|_| damaged())?))
    }

    /// A page's version. `near`: the page of that number in a work at hand and the revision of its
    /// topology, to share it.
    pub fn page(
        &self,
        name: Name,
        near: Option<(&Arc<Page>, u64)>,
    ) -> Result<(Arc<Page>, u64), StoreError> {
        if name.2 == NOTHING {
            return Ok((Arc::new(Page::nothing()), 0));
        }
        let damaged = || StoreError::Damaged(format!("page {} of revision {}", name.1, name.2));
        let row: Option<(i64, u32, Vec<u8>)> = self
            .db
            .prepare_cached(
                "SELECT topology, crc, data FROM page WHERE lineage = ?1 AND number = ?2 AND \
                    revision = ?3",
            )?
            .query_row((name.0, name.1, name.2 as i64), |r| Ok((r.get(0)?, r.get(1)?, r.get(2)?)))
            .optional()?;
        let (topology, crc, data) = row.ok_or_else(damaged)?;
        if crc32fast::hash(&data) != crc {
            return Err(damaged());
        }
        let shape = match near.filter(|(_, t)| *t == topology as u64) {
            Some((page, _)) => page.topology().clone(),
            None => self.topology((name.0, name.1, topology as u64))?,
        };
        let page = Page::from_bytes(&data, shape, name.2).map_err(|_| damaged())?;
        Ok((Arc::new(page), topology as u64))
    }

    /// Bytes of all stored pages and topologies.
    pub fn bytes(&self) -> Result<u64, StoreError> {
        let sum: i64 = self.db.query_row(
            "SELECT (SELECT coalesce(sum(length(data)), 0) FROM page)
                  + (SELECT coalesce(sum(length(data)), 0) FROM topology)",
            [],
            |r| r.get(0),
        )?;
        Ok(sum as u64)
    }

    /// Bytes of all that is kept for the history: pages, topologies, pictures, checkpoints, nodes
    /// and what they name. A session from before there was a table has nothing in it.
    pub fn total(&self) -> Result<u64, StoreError> {
        let columns = [
            ("page", "data"),
            ("topology", "data"),
            ("sight", "png"),
            ("side", "data"),
            ("checkpoint", "data"),
            ("node", "data"),
            ("pin", "data"),
        ];
        let mut sum = 0;
        for (table, column) in columns {
            if self.has_table(table)? {
                let sql = format!("SELECT coalesce(sum(length({column})), 0) FROM {table}");
                sum += self.db.query_row(&sql, [], |r| r.get::<_, i64>(0))?;
            }
        }
        Ok(sum as u64)
    }
}
