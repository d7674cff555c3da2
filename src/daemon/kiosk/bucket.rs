//! A bucket of an S3-compatible store, or another place that `object_store` knows by its address.

use object_store::path::Path;
use object_store::{ObjectStore, ObjectStoreExt, PutPayload};

/// An open place. Keys come from the environment (`AWS_ACCESS_KEY_ID`, `AWS_ENDPOINT`, ...): no secret stands in a settings
/// file.
#[derive(Debug)]
pub struct Bucket {
    store: Box<dyn ObjectStore>,
    prefix: Path,
    runtime: tokio::runtime::Runtime,
}

impl Bucket {
    /// `s3://bucket/folder`, or `file:///folder`.
    ///
    /// # Errors
    /// In words, where nothing of that kind is known.
    pub fn open(place: &str) -> Result<Bucket, String> {
        let url = url::Url::parse(place).map_err(|e| format!("{place}: {e}"))?;
        let keys = std::env::vars().filter(|(k, _)| k.starts_with("AWS_"));
        let (store, prefix) =
            object_store::parse_url_opts(&url, keys.map(|(k, v)| (k.to_ascii_lowercase(), v)))
                .map_err(|e| format!("{place}: {e}"))?;
        let runtime = tokio::runtime::Builder::new_current_thread()
            .enable_all()
            .build()
            .map_err(|e| format!("{place}: {e}"))?;
        Ok(Bucket { store, prefix, runtime })
    }

    /// Puts one object.
    ///
    /// # Errors
    /// In words, where the store refuses or cannot be reached.
    pub fn put(&self, name: &str, bytes: &[u8]) -> Result<(), String> {
        let to = self.prefix.clone().join(name);
        let put = self.store.put(&to, PutPayload::from(bytes.to_vec()));
        self.runtime.block_on(put).map(|_| ()).map_err(|e| e.to_string())
    }
}
