"""Sources that are not ours: the example publishers, run as a reader of the documentation would run them."""

import ast
import subprocess
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any

import httpx
import pytest

from tests.end_to_end.processes import EXAMPLES, Service, until

PUBLISHERS = EXAMPLES / "publishers"
PYTHON = PUBLISHERS / "publisher.py"
MACHINE = "motor-pump"
LONGEST = 40


def source_row(service: Service) -> dict[str, Any] | None:
    rows = service.get("/sources")
    assert len(rows) <= 1
    return dict(rows[0]) if rows else None


def test_the_python_publisher_is_short_and_needs_zenoh_only() -> None:
    text = PYTHON.read_text()
    assert len(text.splitlines()) <= LONGEST
    imported = {name.name for node in ast.walk(ast.parse(text)) if isinstance(node, ast.Import) for name in node.names}
    assert imported - set(sys.stdlib_module_names) == {"zenoh"}
    assert not [node for node in ast.walk(ast.parse(text)) if isinstance(node, ast.ImportFrom)]


@pytest.mark.long
def test_what_a_source_without_a_log_lost_while_the_service_was_dead_is_counted_exactly(service: Service) -> None:
    """It goes on publishing; the numbers it used meanwhile are missing, and no other."""
    samples = 800
    with service.running() as serving:
        service.create(MACHINE)
        arguments = [sys.executable, str(PYTHON), service.endpoint, "examples", MACHINE, "B1L,B1R", str(samples)]
        with subprocess.Popen(arguments, cwd=PUBLISHERS) as publisher:
            until(lambda: (row := source_row(service)) and row["received"] >= 50, within_s=20, what="fifty samples")
            serving.kill()
            serving.wait()
            with service.running():
                assert publisher.wait(60) == 0
                row = until(
                    lambda: (row := source_row(service)) and row["next_sequence"] == samples and row,
                    within_s=20,
                    what="the last",
                )
                held = service.get(f"/machines/{MACHINE}/samples", limit=10_000)
                assert service.get("/quarantine")["counts"] == {}
    assert row is not None
    assert row["received"] + row["lost"] == samples
    assert 20 < row["lost"] < 750
    assert len(held["time"]) == len(set(held["time"])) == row["received"]
    assert held["time"] == sorted(held["time"])


def test_the_shell_publisher_stores_each_sample_though_the_service_is_killed_meanwhile(
    service: Service, tmp_path: Path
) -> None:
    samples = 60
    with service.running() as serving:
        service.create(MACHINE)
        url = f"http://127.0.0.1:{service.port}"
        arguments = ["sh", str(PUBLISHERS / "publish.sh"), url, "examples", MACHINE, "B1L", str(samples)]
        with (tmp_path / "publish.log").open("wb") as log, subprocess.Popen(arguments, stderr=log) as publisher:
            until(lambda: (row := source_row(service)) and row["received"] >= 20, within_s=20, what="twenty samples")
            serving.kill()
            serving.wait()
            with service.running():
                assert publisher.wait(60) == 0, (tmp_path / "publish.log").read_text()
                row = source_row(service)
                held = service.get(f"/machines/{MACHINE}/samples", limit=10_000)
    assert row is not None
    assert (row["received"], row["next_sequence"], row["lost"]) == (samples, samples, 0)
    assert len(set(held["time"])) == samples


@contextmanager
def moody(service: Service, *statuses: int) -> Iterator[str]:
    """Address of a proxy that first answers by itself, and then as the service does."""
    left = list(statuses)

    class PublishHandler(BaseHTTPRequestHandler):
        def do_POST(self) -> None:
            body = self.rfile.read(int(self.headers["content-length"]))
            status, said = (left.pop(0), b"not now") if left else self._asked(body)
            self.send_response(status)
            self.send_header("content-length", str(len(said)))
            self.end_headers()
            self.wfile.write(said)

        def _asked(self, body: bytes) -> tuple[int, bytes]:
            url = f"http://127.0.0.1:{service.port}{self.path}"
            answer = httpx.post(url, content=body, headers={"content-type": "application/json"})
            return answer.status_code, answer.content

        def log_message(self, format: str, *args: Any) -> None:
            """Log nothing."""

    with ThreadingHTTPServer(("127.0.0.1", 0), PublishHandler) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        yield f"http://127.0.0.1:{server.server_address[1]}"
        server.shutdown()
    assert left == []


def published(url: str, machine: str) -> "subprocess.CompletedProcess[str]":
    arguments = ["sh", str(PUBLISHERS / "publish.sh"), url, "examples", machine, "B1L", "3"]
    return subprocess.run(arguments, capture_output=True, text=True, timeout=60, check=False)


def test_the_shell_publisher_tries_again_where_that_helps_and_else_says_why_not(service: Service) -> None:
    with service.running():
        service.create(MACHINE)
        with moody(service, 503, 429, 502) as url:
            assert published(url, MACHINE).returncode == 0
        row = source_row(service)
        assert row is not None
        assert (row["received"], row["lost"], row["duplicates"]) == (3, 0, 0)
        refused = published(f"http://127.0.0.1:{service.port}", "nobody")
        assert (refused.returncode, "no machine 'nobody'" in refused.stderr) == (1, True), refused.stderr
