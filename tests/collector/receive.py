#!/usr/bin/env python3
"""A collector that is not ours: takes OTLP over HTTP and reads it by OpenTelemetry's own messages
(PyPI's `opentelemetry-proto`), strictly: a field that they do not have is an error.

    pip install opentelemetry-proto
    tests/collector/receive.py 4318 --requests 4 &
    OTEL_METRIC_EXPORT_INTERVAL=1000 sculptd run --headless --telemetry http://127.0.0.1:4318 --for 5

Prints one line a metric or a record, and ends with 0 after so many requests.
"""

import argparse
import http.server
import sys

from google.protobuf import json_format
from opentelemetry.proto.collector.logs.v1 import logs_service_pb2 as logs
from opentelemetry.proto.collector.metrics.v1 import metrics_service_pb2 as metrics


def pairs(attributes):
    return {a.key: a.value.string_value for a in attributes}


def read(path, body):
    if path == "/v1/metrics":
        request = json_format.Parse(body, metrics.ExportMetricsServiceRequest())
        for of in request.resource_metrics:
            yield f"resource {pairs(of.resource.attributes)}"
            for m in (m for scope in of.scope_metrics for m in scope.metrics):
                kind = m.WhichOneof("data")
                for p in getattr(m, kind).data_points:
                    value = list(p.bucket_counts) if kind == "histogram" else p.as_int or p.as_double
                    yield f"{kind} {m.name} [{m.unit}] {pairs(p.attributes)} {value}"
    elif path == "/v1/logs":
        request = json_format.Parse(body, logs.ExportLogsServiceRequest())
        for of in request.resource_logs:
            for r in (r for scope in of.scope_logs for r in scope.log_records):
                yield f"{r.severity_text} {r.severity_number} {r.body.string_value} {pairs(r.attributes)}"
    else:
        raise ValueError(f"no such path: {path}")


class Handler(http.server.BaseHTTPRequestHandler):
    def do_POST(self):
        body = self.rfile.read(int(self.headers["Content-Length"]))
        try:
            for line in read(self.path, body):
                print(line, flush=True)
            status = 200
        except (ValueError, json_format.ParseError) as e:
            print(f"FAIL {self.path}: {e}", flush=True)
            self.server.failed += 1
            status = 400
        self.send_response(status)
        self.send_header("Content-Type", "application/json")
        self.end_headers()
        self.wfile.write(b"{}")
        self.server.taken += 1

    def log_message(self, *_):
        pass


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("port", type=int)
    parser.add_argument("--requests", type=int, default=1)
    args = parser.parse_args()
    server = http.server.HTTPServer(("127.0.0.1", args.port), Handler)
    server.taken = server.failed = 0
    while server.taken < args.requests:
        server.handle_request()
    return 1 if server.failed else 0


if __name__ == "__main__":
    sys.exit(main())
