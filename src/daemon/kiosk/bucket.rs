//! A bucket of an S3-compatible store, or another place that `object_store` knows by its address.

use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::time::Duration;

use object_store::aws::AmazonS3Builder;
use object_store::path::Path;
use object_store::{ClientOptions, ObjectStore, ObjectStoreExt, PutPayload, RetryConfig};

/// Time limits for a connection and for one sculpture: some 20 MB over a slow line.
const CONNECT: Duration = Duration::from_secs(5);
const WHOLE: Duration = Duration::from_secs(300);
/// Interval at which a transfer checks whether the program is ending.
const LOOK: Duration = Duration::from_millis(100);

/// An open bucket. Keys come from the environment (`AWS_ACCESS_KEY_ID`, `AWS_ENDPOINT`, ...), so
/// that no settings file contains a secret.
#[derive(Debug)]
pub struct Bucket {
    store: Box<dyn ObjectStore>,
    prefix: Path,
    runtime: tokio::runtime::Runtime,
}

impl Bucket {
    /// `s3://bucket/folder`, or `file:///folder`. Nothing is asked of the store yet.
    ///
    /// # Errors
    /// In words, where nothing of that kind is known.
    pub fn open(place: &str) -> Result<Bucket, String> {
        let url = url::Url::parse(place).map_err(|e| format!("{place}: {e}"))?;
        let said = |e: object_store::Error| format!("{place}: {e}");
        let (store, prefix): (Box<dyn ObjectStore>, Path) = if url.scheme() == "s3" {
            let prefix = Path::from_url_path(url.path()).map_err(|e| format!("{place}: {e}"))?;
            // The spool itself retries, and stops on request.
            let retry =
                RetryConfig { max_retries: 0, retry_timeout: WHOLE, ..RetryConfig::default() };
            let line = ClientOptions::new().with_connect_timeout(CONNECT).with_timeout(WHOLE);
            let http = std::env::var("AWS_ALLOW_HTTP").is_ok_and(|v| v == "true");
            let s3 = AmazonS3Builder::from_env()
                .with_url(place)
                .with_retry(retry)
                .with_client_options(line.with_allow_http(http))
                .build();
            (Box::new(s3.map_err(said)?), prefix)
        } else {
            object_store::parse_url(&url).map_err(said)?
        };
        let runtime = tokio::runtime::Builder::new_current_thread()
            .enable_all()
            .build()
            .map_err(|e| format!("{place}: {e}"))?;
        Ok(Bucket { store, prefix, runtime })
    }

    /// Puts one object, whole or not at all; gives up when `stop` is raised.
    ///
    /// # Errors
    /// In words, where the store refuses or cannot be reached.
    pub fn put(&self, name: &str, bytes: &[u8], stop: &AtomicBool) -> Result<(), String> {
        let to = self.prefix.clone().join(name);
        let put = self.store.put(&to, PutPayload::from(bytes.to_vec()));
        self.wait_for(async { put.await.map(drop) }, stop)
    }

    /// Deletes one object, if it exists; gives up when `stop` is raised.
    ///
    /// # Errors
    /// In words, where the store refuses or cannot be reached.
    pub fn delete(&self, name: &str, stop: &AtomicBool) -> Result<(), String> {
        let of = self.prefix.clone().join(name);
        let delete = async {
            match self.store.delete(&of).await {
                Err(object_store::Error::NotFound { .. }) => Ok(()),
                done => done,
            }
        };
        self.wait_for(delete, stop)
    }

    fn wait_for(
        &self,
        work: impl Future<Output = object_store::Result<()>>,
        stop: &AtomicBool,
    ) -> Result<(), String> {
        self.runtime.block_on(async {
            let mut work = std::pin::pin!(work);
            loop {
                match tokio::time::timeout(LOOK, &mut work).await {
                    Ok(done) => return done.map_err(|e| causes(&e)),
                    Err(_) if stop.load(Relaxed) => return Err("the program ends".into()),
                    Err(_) => {}
                }
            }
        })
    }
}

/// An error with what caused it: the outermost alone says no more than that sending failed.
fn causes(e: &dyn std::error::Error) -> String {
    let mut text = e.to_string();
    let mut inner = e.source();
    while let Some(e) = inner {
        let more = e.to_string();
        if !text.contains(&more) {
            text = format!("{text}: {more}");
        }
        inner = e.source();
    }
    text
}
