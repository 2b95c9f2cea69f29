"""Debian's real Prometheus with the example configuration, which reads a real service; its rules; what the dashboard asks."""

import json
import os
import shutil
import subprocess
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import httpx
import pytest

from formats.wire import JSON, encode_body
from tests.end_to_end.processes import EXAMPLES, Service, until
from tests.plant import KEY, batch, document
from tests.ports import free_port

MONITORING = EXAMPLES / "monitoring"
SAMPLES = 30
RULES = (MONITORING / "rundown-rules.yml").read_text().count("- alert:")


def program(name: str) -> str:
    """Return where a program of Debian's package prometheus is."""
    found = shutil.which(name)
    if found is None:
        if os.environ.get("RUNDOWN_REQUIRE_ALL"):
            pytest.fail(f"{name} is not installed; .ci/run installs it")
        pytest.skip(f"{name} is not installed")
    return found


def promtool(*arguments: str) -> str:
    """Return what promtool prints; it must find nothing wrong."""
    ended = subprocess.run(
        [program("promtool"), *arguments], cwd=MONITORING, capture_output=True, text=True, timeout=60, check=False
    )
    assert ended.returncode == 0, ended.stdout + ended.stderr
    return ended.stdout


def test_the_example_configuration_and_its_rules_are_right() -> None:
    assert "SUCCESS" in promtool("check", "config", "prometheus.yml")
    promtool("check", "rules", "--lint=all", "--lint-fatal", "rundown-rules.yml")


def test_the_rules_fire_when_they_should() -> None:
    assert "SUCCESS" in promtool("test", "rules", "rundown-rules-test.yml")


@pytest.fixture
def service(tmp_path: Path) -> Iterator[tuple[Service, subprocess.Popen[bytes]]]:
    """A service that stored some samples, rejected a batch, and runs; its process."""
    one = Service(tmp_path)
    with one.running() as process:
        assert one.client.post("/machines", json=document()).status_code == 201
        path, headers = f"/machines/{KEY.machine}/samples", {"content-type": JSON}
        taken = one.client.post(path, content=encode_body(batch([900.0] * SAMPLES), JSON), headers=headers)
        assert taken.json()["received"] == SAMPLES
        assert one.client.post(path, content=b"{}", headers=headers).status_code == 400
        yield one, process
    one.client.close()


class Prometheus:
    """A Prometheus with the example configuration, which asks this service every second."""

    def __init__(self, folder: Path, service: Service) -> None:
        text = (MONITORING / "prometheus.yml").read_text()
        for old, new in (("127.0.0.1:8080", f"127.0.0.1:{service.port}"), ("_interval: 15s", "_interval: 1s")):
            assert old in text
            text = text.replace(old, new)
        (folder / "prometheus.yml").write_text(text)
        shutil.copy(MONITORING / "rundown-rules.yml", folder)
        self.url = f"http://127.0.0.1:{free_port()}"
        self.arguments = [
            f"--config.file={folder}/prometheus.yml",
            f"--storage.tsdb.path={folder}/data",
            f"--web.listen-address={self.url.removeprefix('http://')}",
        ]

    def get(self, path: str, **asked: str) -> Any:
        """Return what its API answers; None while it does not."""
        try:
            answer = httpx.get(f"{self.url}/api/v1/{path}", params=asked, trust_env=False)
        except httpx.TransportError:
            return None
        return answer.json()["data"] if answer.is_success else None

    def query(self, expression: str) -> list[dict[str, Any]]:
        """The vector that an expression is now; it must be one that Prometheus understands."""
        found = self.get("query", query=expression)
        assert found is not None, expression
        vector: list[dict[str, Any]] = found["result"]
        return vector

    def health(self) -> str | None:
        """Return the health of the service as Prometheus's target."""
        targets = (self.get("targets") or {}).get("activeTargets") or [{"health": None}]
        return str(targets[0]["health"])


@pytest.fixture
def prometheus(tmp_path: Path, service: tuple[Service, subprocess.Popen[bytes]]) -> Iterator[Prometheus]:
    """A Prometheus that runs until the test is over."""
    one = Prometheus(tmp_path, service[0])
    with (tmp_path / "prometheus.log").open("w") as log:
        process = subprocess.Popen([program("prometheus"), *one.arguments], stdout=log, stderr=log)
        try:
            until(lambda: one.health() == "up", within_s=30, what="Prometheus has read the service")
            yield one
        finally:
            process.kill()
            process.wait()


def test_prometheus_reads_the_service_and_notices_when_it_is_gone(
    service: tuple[Service, subprocess.Popen[bytes]], prometheus: Prometheus
) -> None:
    received = prometheus.query(f'rundown_samples_received_total{{job="rundown", machine="{KEY.machine}"}}')
    assert [float(one["value"][1]) for one in received] == [SAMPLES]
    rejected = prometheus.query("rundown_rejected_total > 0")
    assert [one["metric"]["reason"] for one in rejected] == ["undecodable"]

    dashboard = json.loads((MONITORING / "grafana-dashboard.json").read_text())
    expressions = [target["expr"] for panel in dashboard["panels"] for target in panel["targets"]]
    # Rates need two readings.
    until(lambda: prometheus.query("rate(rundown_samples_received_total[5m])") or None, within_s=20, what="two readings")
    assert [one for one in expressions if not prometheus.query(one)] == []
    # What the rules look for a rise of is there before the first incident.
    for name, state in (("identification_jobs", "failed"), ("identification_jobs", "quarantined"), ("deliveries", "given_up")):
        found = prometheus.query(f'rundown_{name}{{state="{state}"}}')
        assert [float(one["value"][1]) for one in found] == [0.0], (name, state)
    prometheus.query(dashboard["annotations"]["list"][0]["expr"])

    def rules() -> dict[str, dict[str, Any]] | None:
        (group,) = prometheus.get("rules")["groups"]
        found = {one["name"]: one for one in group["rules"]}
        return found if all(one["health"] == "ok" for one in found.values()) else None

    def active() -> set[str]:
        """Alarms, but for the one of the disk on which the tests happen to run."""
        return {name for name, one in (rules() or {}).items() if one["state"] != "inactive"} - {"RundownDiskTight"}

    assert len(until(rules, within_s=20, what="all rules were evaluated")) == RULES
    # The samples of the test are of 2023.
    until(lambda: active() == {"RundownSilentMachine"}, within_s=20, what="the silent machine, and nothing else")
    service[1].kill()
    until(lambda: prometheus.health() == "down", within_s=20, what="the service is down")
    until(lambda: "RundownDown" in active(), within_s=20, what="its alert is pending")
