//! `sculptd run --telemetry [URL]`: sends metrics and the log to an OpenTelemetry collector. It
//! reads the standard variables: `OTEL_EXPORTER_OTLP_ENDPOINT`, `OTEL_EXPORTER_OTLP_HEADERS`,
//! `OTEL_RESOURCE_ATTRIBUTES`, `OTEL_SERVICE_NAME`, `OTEL_METRIC_EXPORT_INTERVAL` (milliseconds).

use std::fmt::Write as _;
use std::sync::{Arc, LazyLock};
use std::time::Duration;

use tracing::field::{Field, Visit};
use tracing::{Event, Subscriber};
use tracing_subscriber::Layer;
use tracing_subscriber::layer::Context;

use super::Fail;
use sculptd_daemon::telemetry::endpoint::Endpoint;
use sculptd_daemon::telemetry::log_queue::{LogQueue, LogRecord};
use sculptd_daemon::telemetry::otlp::Resource;
use sculptd_daemon::telemetry::{TelemetryOptions, host_name};

/// Address of a collector on this computer.
const NEAR: &str = "http://127.0.0.1:4318";
/// Default interval between two exports.
const EVERY_MS: u64 = 15_000;
/// Least and greatest interval.
const BOUNDS_MS: (u64, u64) = (100, 3_600_000);

static LOGS: LazyLock<Arc<LogQueue>> = LazyLock::new(Arc::default);

/// Returns the options of `--telemetry`. `url`: the given value, empty if there is none.
///
/// # Errors
/// Returns [`Fail::Usage`] for an invalid value.
pub fn options(url: &str) -> Result<TelemetryOptions, Fail> {
    let env = |name: &str| std::env::var(name).ok().filter(|v| !v.trim().is_empty());
    let (name, text) = match (url, env("OTEL_EXPORTER_OTLP_ENDPOINT")) {
        ("", Some(text)) => ("OTEL_EXPORTER_OTLP_ENDPOINT", text),
        ("", None) => ("--telemetry", NEAR.into()),
        (url, _) => ("--telemetry", url.into()),
    };
    let headers = env("OTEL_EXPORTER_OTLP_HEADERS").unwrap_or_default();
    let endpoint =
        Endpoint::read(&text, &headers).map_err(|e| Fail::Usage(format!("{name}: {e}")))?;
    let every_ms = match env("OTEL_METRIC_EXPORT_INTERVAL") {
        None => EVERY_MS,
        Some(text) => text.trim().parse().map_err(|_| {
            Fail::Usage("OTEL_METRIC_EXPORT_INTERVAL: expected milliseconds".to_owned())
        })?,
    };
    let mut resource = Resource::default();
    let host = host_name();
    resource.set("service.name", "sculptd");
    resource.set("service.version", env!("CARGO_PKG_VERSION"));
    resource.set("service.instance.id", format!("{host}:{}", std::process::id()));
    resource.set("host.name", host);
    resource.set_all(&env("OTEL_RESOURCE_ATTRIBUTES").unwrap_or_default());
    if let Some(name) = env("OTEL_SERVICE_NAME") {
        resource.set("service.name", name);
    }
    Ok(TelemetryOptions {
        endpoint,
        every: Duration::from_millis(every_ms.clamp(BOUNDS_MS.0, BOUNDS_MS.1)),
        resource,
        now_ns,
        logs: LOGS.clone(),
    })
}

#[allow(clippy::disallowed_methods)] // The edge: a collector knows the calendar only.
fn now_ns() -> u64 {
    let now = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH);
    now.map_or(0, |d| u64::try_from(d.as_nanos()).unwrap_or(u64::MAX))
}

/// The layer of the log that puts lines aside for a collector, where one is wanted.
#[derive(Debug, Clone, Copy)]
pub struct ExportLayer;

#[derive(Default)]
struct Fields {
    text: String,
    others: Vec<(String, String)>,
}

impl Visit for Fields {
    fn record_debug(&mut self, field: &Field, value: &dyn std::fmt::Debug) {
        match field.name() {
            // Writing to a text cannot fail.
            "message" => drop(write!(self.text, "{value:?}")),
            name => self.others.push((name.into(), format!("{value:?}"))),
        }
    }

    fn record_str(&mut self, field: &Field, value: &str) {
        self.record_debug(field, &format_args!("{value}"));
    }
}

impl<S: Subscriber> Layer<S> for ExportLayer {
    fn on_event(&self, event: &Event<'_>, _: Context<'_, S>) {
        if !LOGS.is_open() {
            return;
        }
        let mut fields = Fields::default();
        event.record(&mut fields);
        let meta = event.metadata();
        LOGS.push(LogRecord {
            number: 0,
            at_ns: now_ns(),
            level: *meta.level(),
            target: meta.target().into(),
            text: fields.text,
            fields: fields.others,
        });
    }
}
