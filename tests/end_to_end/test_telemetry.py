"""Traces of the API reach a collector by OTLP, with nothing but OpenTelemetry's own variables set."""

import http.server
import threading
from pathlib import Path

import pytest

from tests.databases import Databases
from tests.end_to_end.processes import Service, until

pytest.importorskip("opentelemetry.sdk")


class TelemetryCollector(http.server.BaseHTTPRequestHandler):
    """Keeps what it is sent."""

    bodies: list[tuple[str, bytes]] = []  # noqa: RUF012

    def do_POST(self) -> None:
        length = int(self.headers["content-length"])
        self.bodies.append((self.path, self.rfile.read(length)))
        self.send_response(200)
        self.send_header("content-length", "0")
        self.end_headers()

    def log_message(self, *_: object) -> None:
        """Log nothing."""


def test_requests_are_spans(tmp_path: Path, databases: Databases) -> None:
    with http.server.ThreadingHTTPServer(("127.0.0.1", 0), TelemetryCollector) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        service = Service(
            tmp_path,
            database=databases.new(tmp_path / "rundown.db"),
            FASTAPI_OTEL_AUTO_CONFIGURE="true",
            OTEL_EXPORTER_OTLP_ENDPOINT=f"http://127.0.0.1:{server.server_port}",
            OTEL_EXPORTER_OTLP_COMPRESSION="none",
            OTEL_SERVICE_NAME="rundown-under-test",
            OTEL_BSP_SCHEDULE_DELAY="200",
        )
        with service.running():
            service.get("/machines")
            until(
                lambda: any(path == "/v1/traces" and b"/api/v1/machines" in body for path, body in TelemetryCollector.bodies),
                within_s=20,
                what="the request is a span at the collector",
            )
        service.client.close()
        server.shutdown()
    assert any(b"rundown-under-test" in body for _, body in TelemetryCollector.bodies)
