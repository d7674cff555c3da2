//! The bodies of OTLP's requests, as the JSON mapping of its messages has them
//! (opentelemetry-proto 1.x; numbers of 64 bits are texts).

use serde_json::{Value, json};
use tracing::Level;

use super::log_queue::LogRecord;
use crate::metric_table::{Metric, MetricKind, STAGES_HELP, STAGES_NAME, StageHistogram};

/// `AGGREGATION_TEMPORALITY_CUMULATIVE`: sums since the daemon began.
const CUMULATIVE: u32 = 2;

/// Who sends: attributes, as OpenTelemetry's conventions name them.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Resource(pub Vec<(String, String)>);

impl Resource {
    /// Sets an attribute; one of that name is replaced.
    pub fn set(&mut self, key: &str, value: impl Into<String>) {
        self.0.retain(|(k, _)| k != key);
        self.0.push((key.into(), value.into()));
    }

    /// Takes attributes in the format of `OTEL_RESOURCE_ATTRIBUTES`: `KEY=VALUE` separated by
    /// commas, with percent-encoded values. Invalid parts are ignored.
    pub fn set_all(&mut self, text: &str) {
        for (key, value) in text.split(',').filter_map(|pair| pair.split_once('=')) {
            let value = super::endpoint::unescaped(value.trim());
            if let Some(value) = value.and_then(|v| String::from_utf8(v).ok()) {
                self.set(key.trim(), value);
            }
        }
    }

    fn to_json(&self) -> Value {
        json!({ "attributes": attributes(self.0.iter().map(|(k, v)| (k.as_str(), v.as_str()))) })
    }
}

fn attributes<'a>(pairs: impl Iterator<Item = (&'a str, &'a str)>) -> Vec<Value> {
    pairs.map(|(key, value)| json!({ "key": key, "value": { "stringValue": value } })).collect()
}

fn scope() -> Value {
    json!({ "name": "sculptd", "version": env!("CARGO_PKG_VERSION") })
}

/// The name and the unit (UCUM) of a figure: that of Prometheus without the endings that say what
/// its unit and kind say here.
pub fn name_and_unit(name: &str) -> (String, &'static str) {
    let unit = if name.contains("_seconds") { "s" } else { "1" };
    let plain = name.trim_end_matches("_total").replace("_seconds", "");
    (format!("sculptd.{plain}"), unit)
}

/// The body of a request with all figures. `times`: when counting began, and now, in nanoseconds
/// since 1970.
pub fn metrics(
    resource: &Resource,
    values: &[Metric],
    stages: &[StageHistogram],
    times: (u64, u64),
) -> String {
    let (start, now) = (times.0.to_string(), times.1.to_string());
    let one = |f: &Metric| {
        let (name, unit) = name_and_unit(f.name);
        let mut metric = json!({ "name": name, "description": f.help, "unit": unit });
        match f.kind {
            MetricKind::Counter => {
                let point = json!({
                    "startTimeUnixNano": start, "timeUnixNano": now,
                    "asInt": (f.value as u64).to_string(),
                });
                metric["sum"] = json!({
                    "dataPoints": [point],
                    "aggregationTemporality": CUMULATIVE,
                    "isMonotonic": true,
                });
            }
            MetricKind::Gauge => {
                let point = json!({ "timeUnixNano": now, "asDouble": f.value });
                metric["gauge"] = json!({ "dataPoints": [point] });
            }
        }
        metric
    };
    let points: Vec<Value> = stages.iter().map(|s| histogram_point(s, &start, &now)).collect();
    let (name, unit) = name_and_unit(STAGES_NAME);
    let histogram = json!({
        "name": name, "description": STAGES_HELP, "unit": unit,
        "histogram": { "dataPoints": points, "aggregationTemporality": CUMULATIVE },
    });
    let all: Vec<Value> = values.iter().map(one).chain([histogram]).collect();
    json!({ "resourceMetrics": [{
        "resource": resource.to_json(),
        "scopeMetrics": [{ "scope": scope(), "metrics": all }],
    }] })
    .to_string()
}

/// Counts of each class, where Prometheus has those of all classes up to each.
fn histogram_point(s: &StageHistogram, start: &str, now: &str) -> Value {
    let upto = s.at_most.iter().map(|b| b.1).chain([s.count]);
    let below = [0].into_iter().chain(s.at_most.iter().map(|b| b.1));
    let counts: Vec<String> =
        upto.zip(below).map(|(upto, below)| upto.saturating_sub(below).to_string()).collect();
    let bounds: Vec<f64> = s.at_most.iter().map(|b| b.0).collect();
    json!({
        "attributes": attributes([("stage", s.stage)].into_iter()),
        "startTimeUnixNano": start, "timeUnixNano": now,
        "count": s.count.to_string(), "sum": s.sum_s,
        "bucketCounts": counts, "explicitBounds": bounds,
    })
}

/// The body of a request with lines of the log.
pub fn logs(resource: &Resource, records: &[LogRecord]) -> String {
    let one = |r: &LogRecord| {
        // Of each severity the first of its four numbers.
        let (number, text) = match r.level {
            Level::ERROR => (17, "ERROR"),
            Level::WARN => (13, "WARN"),
            Level::INFO => (9, "INFO"),
            Level::DEBUG => (5, "DEBUG"),
            Level::TRACE => (1, "TRACE"),
        };
        let fields = r.fields.iter().map(|(k, v)| (k.as_str(), v.as_str()));
        let target = [("code.namespace", r.target.as_str())].into_iter();
        json!({
            "timeUnixNano": r.at_ns.to_string(), "observedTimeUnixNano": r.at_ns.to_string(),
            "severityNumber": number, "severityText": text,
            "body": { "stringValue": r.text },
            "attributes": attributes(target.chain(fields)),
        })
    };
    let all: Vec<Value> = records.iter().map(one).collect();
    json!({ "resourceLogs": [{
        "resource": resource.to_json(),
        "scopeLogs": [{ "scope": scope(), "logRecords": all }],
    }] })
    .to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_lose_what_their_unit_and_kind_say() {
        let of = |name| name_and_unit(name);
        assert_eq!(of("ticks_total"), ("sculptd.ticks".into(), "1"));
        assert_eq!(of("tick_seconds_p99"), ("sculptd.tick_p99".into(), "s"));
        assert_eq!(of("sample_to_present_seconds"), ("sculptd.sample_to_present".into(), "s"));
    }

    #[test]
    fn a_histogram_has_the_count_of_each_class_and_one_beyond() {
        let at_most = vec![(0.001, 2), (0.01, 5)];
        let stage = StageHistogram { stage: "total", at_most, sum_s: 0.5, count: 9 };
        let body: Value =
            serde_json::from_str(&metrics(&Resource::default(), &[], &[stage], (1, 2)))
                .expect("JSON");
        let metric = &body["resourceMetrics"][0]["scopeMetrics"][0]["metrics"][0];
        let point = &metric["histogram"]["dataPoints"][0];
        assert_eq!(point["bucketCounts"], json!(["2", "3", "4"]));
        assert_eq!(point["explicitBounds"], json!([0.001, 0.01]));
        assert_eq!((point["count"].as_str(), point["sum"].as_f64()), (Some("9"), Some(0.5)));
    }

    #[test]
    fn attributes_of_the_environment_replace_our_own() {
        let mut resource = Resource::default();
        resource.set("service.name", "sculptd");
        resource.set_all("service.name=hall%203,broken,place=M%C3%BCnchen,x=%ff");
        let expected = [("service.name", "hall 3"), ("place", "München")];
        assert_eq!(resource.0, expected.map(|(k, v)| (k.to_owned(), v.to_owned())));
    }
}
