"""The files of deploy/: commands and settings are those of the service, and the programs that read them take them."""

import json
import os
import re
import shlex
import shutil
import subprocess
import sys
import time
import tomllib
from collections.abc import Callable, Iterator
from ipaddress import ip_address, ip_network
from pathlib import Path
from typing import Any

import pytest
import typer.main
import yaml
from cryptography import x509
from grafana_foundation_sdk.cog.encoder import JSONEncoder
from grafana_foundation_sdk.cog.plugins import register_default_plugins
from grafana_foundation_sdk.models.dashboard import Dashboard

from rotorundown.environment.release import VERSION
from service.commands.app import app
from service.configuration.settings import Settings
from service.configuration.settings_file import VARIABLE
from service.security.exposure import host_of
from storage.backup import backup_file
from storage.database.engine import Database
from tests.plant import sqlite_url

ROOT = Path(__file__).parents[2]
DEPLOY = ROOT / "deploy"
UNITS = sorted((DEPLOY / "systemd").glob("*.service"))
BACKUP = DEPLOY / "systemd" / "rundown-backup.service"
COMPOSE = DEPLOY / "compose" / "compose.yaml"
KUBERNETES = DEPLOY / "kubernetes" / "rundown.yaml"
DASHBOARD = ROOT / "examples" / "monitoring" / "grafana-dashboard.json"
RULES = ROOT / "examples" / "monitoring" / "rundown-rules.yml"
SERVICE_FIELDS = {
    *("build", "cap_add", "cap_drop", "command", "configs", "depends_on", "entrypoint", "environment", "env_file", "expose"),
    *("healthcheck", "image", "networks", "ports", "read_only", "restart", "secrets", "security_opt", "stop_grace_period"),
    *("stop_signal", "tmpfs", "user", "volumes", "working_dir"),
}
"""Fields of a service as the Compose Specification has them, those that a deployment may want."""


def compose() -> dict[str, Any]:
    return dict(yaml.safe_load(COMPOSE.read_text()))


def manifests() -> list[dict[str, Any]]:
    return [one for one in yaml.safe_load_all(KUBERNETES.read_text()) if one]


def commands() -> Iterator[tuple[str, list[str]]]:
    """Every command line that a file gives to the service, and where it stands."""
    for unit in UNITS:
        if unit == BACKUP:
            continue  # it runs a script, which a test runs as well
        (line,) = re.findall(r"^ExecStart=/opt/rundown/bin/rundown (.*)$", unit.read_text(), re.MULTILINE)
        for role in ("ingest", "identify", "api") if "%i" in line else ("",):
            words = line.replace("%i", role).replace("${PROCESSES}", "2").replace("${", "").replace("}", "")
            yield unit.name, shlex.split(words)
    for name, service in compose()["services"].items():
        if "rundown" in service.get("image", ""):
            yield f"compose {name}", service["command"]
    for one in manifests():
        if one["kind"] == "Deployment":
            yield f"kubernetes {one['metadata']['name']}", one["spec"]["template"]["spec"]["containers"][0]["args"]
    (line,) = re.findall(r"^exec /opt/rundown/bin/rundown (.*)$", (DEPLOY / "zenoh/plant-router.sh").read_text(), re.MULTILINE)
    yield "plant-router.sh", shlex.split(line)
    readme = (DEPLOY / "README.md").read_text()
    for line in re.findall(r"^docker compose run --rm api (.*?)(?:  |$)", readme, re.MULTILINE):
        yield "README.md", shlex.split(line)
    for line in re.findall(r"^docker compose exec api rundown (.*)$", readme, re.MULTILINE):
        yield "README.md", shlex.split(line)


@pytest.mark.parametrize(("where", "words"), list(commands()))
def test_the_service_knows_every_command(where: str, words: list[str]) -> None:
    command: Any = typer.main.get_command(app)
    name = "rundown"
    while hasattr(command, "commands"):
        assert words[0] in command.commands, f"{where}: no command {words[0]}"
        name, command, words = words[0], command.commands[words[0]], words[1:]
    command.make_context(name, list(words))  # raises for an option that is not there


def test_every_setting_that_a_file_names_is_one() -> None:
    known = {f"RUNDOWN_{name.upper()}" for name in Settings.model_fields}
    found = 0
    for file in [*DEPLOY.rglob("*"), *(ROOT / "docs").glob("*.md")]:
        if file.is_file():
            for name in re.findall(r"RUNDOWN_[A-Z0-9_]*[A-Z0-9]\b(?!…)", file.read_text()):
                if name in ("RUNDOWN_TEST_DATABASE", "RUNDOWN_REQUIRE_ALL", VARIABLE) or f"{name}_…" in file.read_text():
                    continue
                assert name in known, f"{file.relative_to(ROOT)}: no setting {name}"
                found += 1
    assert found > 20


def test_containers_get_what_the_image_gives() -> None:
    """The user who runs it, and who the volumes and secrets belong to, is one and the same."""
    image = (DEPLOY / "Containerfile").read_text()
    (user,) = re.findall(r"^USER (\d+)$", image, re.MULTILINE)
    assert f"--uid {user}" in image
    assert f"chown {user} secrets/database_url" in (DEPLOY / "compose/secrets.sh").read_text()
    for one in manifests():
        if one["kind"] == "Deployment":
            assert one["spec"]["template"]["spec"]["securityContext"]["runAsUser"] == int(user)
    for path in re.findall(r"^COPY (?!--from)(.*) \S+$", image, re.MULTILINE):
        for name in path.split():
            assert (ROOT / name).exists(), name


OF_NO_CONTAINER = {"frames", "plots", "docs", "sbom", "dev"}
"""Extras of the library in a notebook, and of who works on the project."""


def test_the_image_has_what_a_container_may_need_and_is_of_this_release() -> None:
    """Settings turn on a broker, OPC UA, traces or vendors' files: a container cannot install anything for them."""
    image = (DEPLOY / "Containerfile").read_text()
    (installed,) = re.findall(r"'\.\[(.*)\]'", image)
    extras = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["optional-dependencies"]
    assert set(installed.split(",")) == set(extras) - OF_NO_CONTAINER
    readme = (DEPLOY / "README.md").read_text()
    (on_a_machine,) = re.findall(r"pip install '\.\[(.*)\]'", readme)
    assert set(on_a_machine.split(",")) <= set(extras)
    (of_settings,) = re.findall(r"^The installation has what most need\. (.*?)\n\n", readme, re.MULTILINE | re.DOTALL)
    later = set(re.findall(r"`([a-z0-9]+)`", of_settings))
    assert set(on_a_machine.split(",")) | later == set(extras) - OF_NO_CONTAINER
    named = {one.removeprefix("RUNDOWN_").lower() for one in re.findall(r"`(RUNDOWN_\w+)`", of_settings)}
    assert named
    assert named <= set(Settings.model_fields)
    release = VERSION.rpartition(".")[0]
    for file in (COMPOSE, KUBERNETES):
        assert set(re.findall(r"image: rundown:(\S+)", file.read_text())) == {release}, file.name


def test_compose_knows_every_field() -> None:
    """A misspelt one is refused by some versions of compose, and passed over by others."""
    whole = compose()
    parts = {one for one in whole if not one.startswith("x-")}
    assert parts <= {"name", "services", "networks", "volumes", "secrets", "configs"}
    fields = {name: set(service) - SERVICE_FIELDS for name, service in whole["services"].items()}
    assert {name: unknown for name, unknown in fields.items() if unknown} == {}
    for name, service in whole["services"].items():
        assert set(service.get("depends_on", ())) <= set(whole["services"]), name
        assert set(service.get("networks", ())) <= set(whole["networks"]), name
        assert set(service.get("configs", ())) <= set(whole["configs"]), name


def test_compose_holds_together() -> None:
    whole = compose()
    for name, service in whole["services"].items():
        assert set(service.get("secrets", [])) <= set(whole["secrets"]), name
        for volume in service.get("volumes", []):
            source = volume.split(":")[0]
            made_by_hand = source == "/backup/rundown"  # as the steps say, see below
            assert source in whole["volumes"] or (COMPOSE.parent / source).exists() or made_by_hand, f"{name}: {source}"
    made = (DEPLOY / "compose/secrets.sh").read_text()
    for name, secret in whole["secrets"].items():
        assert secret["file"].removeprefix("./") in made, name


@pytest.mark.parametrize("unit", UNITS, ids=lambda unit: unit.name)
def test_units_are_right(unit: Path) -> None:
    if shutil.which("systemd-analyze") is None:
        pytest.skip("systemd-analyze is not installed")
    told = subprocess.run(["systemd-analyze", "verify", str(unit)], capture_output=True, text=True, check=False).stderr
    of_ours = [line for line in told.splitlines() if "rundown" in line and "is not executable" not in line]
    assert not of_ours


def test_the_dashboard_is_one_by_grafanas_own_models() -> None:
    """Read by them and written again it is the same: no field that Grafana does not know, none of another kind."""
    register_default_plugins()
    told = json.loads(DASHBOARD.read_text())
    found = Dashboard.from_json(told)
    assert [(one.title, one.type_val) for one in found.panels or []] == [(one["title"], one["type"]) for one in told["panels"]]
    written = json.loads(JSONEncoder().encode(found))
    lost = [place for place in missing(told, written) if place != "/annotations/list/0/titleFormat"]  # the data source's own
    assert lost == []


def missing(told: Any, written: Any, place: str = "") -> Iterator[str]:
    """Yield where something was told that was not written again, or otherwise."""
    if isinstance(told, dict) and isinstance(written, dict):
        for name, value in told.items():
            yield from missing(value, written.get(name), f"{place}/{name}")
    elif isinstance(told, list) and isinstance(written, list) and len(told) == len(written):
        for number, (one, other) in enumerate(zip(told, written, strict=True)):
            yield from missing(one, other, f"{place}/{number}")
    elif told != written:
        yield place


def test_every_alarm_is_in_the_runbook() -> None:
    alarms = [rule["alert"] for group in yaml.safe_load(RULES.read_text())["groups"] for rule in group["rules"]]
    runbook = (ROOT / "docs" / "runbook.md").read_text()
    assert re.findall(r"^\| (Rundown\w+) \|", runbook, re.MULTILINE) == alarms


def test_prometheus_and_alertmanager_take_their_files(tmp_path: Path) -> None:
    for program in ("promtool", "amtool"):
        if shutil.which(program) is None:
            pytest.skip(f"{program} is not installed")
    written = (COMPOSE.parent / "prometheus/prometheus.yml").read_text()
    key = tmp_path / "key"
    key.write_text("k")
    here = written.replace("/etc/prometheus/rundown-rules.yml", str(RULES)).replace("/run/secrets/metrics_key", str(key))
    (tmp_path / "prometheus.yml").write_text(here)
    subprocess.run(["promtool", "check", "config", str(tmp_path / "prometheus.yml")], check=True, capture_output=True)
    subprocess.run(
        ["amtool", "check-config", str(COMPOSE.parent / "alertmanager/alertmanager.yml")], check=True, capture_output=True
    )


def container_settings(where: str) -> dict[str, str]:
    """Return what the service is told in containers; where compose asks the environment, what it takes without an answer
    there."""
    told = compose()["x-settings"] if where == "compose" else manifests()[0]["data"]
    return {name: re.sub(r"\$\{\w+:-(.*?)\}", r"\1", value) for name, value in told.items()}


@pytest.mark.parametrize("where", ["compose", "kubernetes"])
def test_containers_know_how_large_the_database_may_become(where: str) -> None:
    """Of PostgreSQL nothing else is known, and RundownDiskTight could not fire."""
    told = container_settings(where)
    assert told["RUNDOWN_DATABASE_FILE"].startswith("/run/secrets/")
    assert Settings(disk_budget_gb=float(told["RUNDOWN_DISK_BUDGET_GB"])).disk_budget_gb > 0


def certified(certificate: Path) -> set[str]:
    """Names and addresses that a certificate is good for, by which whoever connects knows it."""
    names = x509.load_pem_x509_certificate(certificate.read_bytes()).extensions.get_extension_for_class(
        x509.SubjectAlternativeName
    )
    return {str(name.value) for name in names.value}


def as_kubernetes_says(folder: Path) -> Path:
    """Make the certificates as the manifest's first lines say; returns where they are."""
    for line in re.findall(r"^#   (deploy/certificates\.sh [^#\n]*)", KUBERNETES.read_text(), re.MULTILINE):
        script, _, *names = shlex.split(line)
        subprocess.run([ROOT / script, folder, *names], check=True, capture_output=True, timeout=30)
    return folder


def as_compose_says(folder: Path) -> Path:
    """The same, as compose's script does it; that one is for root, and for a folder beside it."""
    for line in re.findall(
        r"\|\| \.\./(certificates\.sh secrets .*)$", (COMPOSE.parent / "secrets.sh").read_text(), re.MULTILINE
    ):
        script, _, *names = shlex.split(line.replace('"$@"', "centre.example 192.0.2.7"))
        subprocess.run([DEPLOY / script, folder, *names], check=True, capture_output=True, timeout=30)
    return folder


@pytest.mark.parametrize(("where", "made"), [("compose", as_compose_says), ("kubernetes", as_kubernetes_says)])
def test_the_router_has_a_certificate_for_the_name_that_it_is_reached_by(
    where: str, made: Callable[[Path], Path], tmp_path: Path
) -> None:
    """zenoh compares them, and refuses the router otherwise."""
    (endpoint,) = json.loads(container_settings(where)["RUNDOWN_ZENOH_CONNECT"])
    folder = made(tmp_path / "tls")
    assert host_of(endpoint) in certified(folder / "router.crt")
    wanted = re.findall(r"tls/(\S+?\.(?:crt|key))", KUBERNETES.read_text())
    assert len(wanted) == 5
    assert all((folder / name).exists() for name in wanted)


def test_proxies_are_believed_by_their_address_only() -> None:
    """In compose it is the gateway of the network, by which the port on the host's loopback is reached."""
    whole = compose()
    (network,) = whole["networks"]["plant"]["ipam"]["config"]
    api = whole["services"]["api"]
    assert json.loads(api["environment"]["RUNDOWN_TRUSTED_PROXIES"]) == [network["gateway"]]
    assert ip_address(network["gateway"]) in ip_network(network["subnet"])
    assert all(one.startswith("127.0.0.1:") for one in api["ports"])
    for name, service in whole["services"].items():
        assert name == "api" or "RUNDOWN_TRUSTED_PROXIES" not in service.get("environment", {}), name


def test_containers_are_told_where_people_reach_them() -> None:
    """Compose by its environment, which the steps set; the example's name has to be changed in either."""
    assert compose()["x-settings"]["RUNDOWN_PUBLIC_URL"] == "${RUNDOWN_PUBLIC_URL:-}"
    assert "echo RUNDOWN_PUBLIC_URL=https://rundown.example >> .env" in (DEPLOY / "README.md").read_text()
    assert manifests()[0]["data"]["RUNDOWN_PUBLIC_URL"] == "https://rundown.example"


def test_the_proxy_asks_where_the_api_listens(tmp_path: Path) -> None:
    """In the layout of one process, which has the default, and in the one of several, as the steps set their ports."""
    (port,) = re.findall(r"^    server 127\.0\.0\.1:(\d+);$", (DEPLOY / "nginx/rundown.conf").read_text(), re.MULTILINE)
    assert int(port) == Settings.model_fields["port"].default
    (line,) = re.findall(r"^(.*RUNDOWN_PORT.*)$", (DEPLOY / "README.md").read_text(), re.MULTILINE)
    subprocess.run(["bash", "-c", line.replace("/etc/rundown", str(tmp_path))], check=True, timeout=10)
    ports = dict.fromkeys(("ingest", "identify", "api"), port)
    for file in tmp_path.glob("*.env"):
        ports[file.stem] = file.read_text().strip().removeprefix("RUNDOWN_PORT=")
    assert ports["api"] == port
    assert len(set(ports.values())) == 3


def nightly_backup(folder: Path, url: str) -> int:
    """Run the script that all layouts run; its status."""
    around = os.environ | {"RUNDOWN_DATABASE": url, "PATH": f"{Path(sys.executable).parent}:{os.environ['PATH']}"}
    return subprocess.run([DEPLOY / "nightly-backup.sh", folder], env=around, timeout=60, check=False).returncode


def test_the_nightly_backup_is_one_and_old_ones_go(tmp_path: Path) -> None:
    Database(sqlite_url(tmp_path / "rundown.db")).close()
    folder = tmp_path / "backup"
    folder.mkdir()
    for name, age_days in (("rundown-old", 16), ("rundown-old.json", 16), ("rundown-recent", 13), ("notes", 400)):
        (folder / name).write_text(name)
        then = time.time() - age_days * 86_400
        os.utime(folder / name, (then, then))
    kept = {path.name for path in folder.iterdir()}
    assert nightly_backup(folder, sqlite_url(tmp_path / "nowhere" / "rundown.db")) != 0
    assert {path.name for path in folder.iterdir()} == kept
    assert nightly_backup(folder, sqlite_url(tmp_path / "rundown.db")) == 0
    made = [path for path in folder.glob("rundown-2*") if path.suffix != ".json"]
    assert [backup_file.read(one).kind for one in made] == ["sqlite"]
    others = {path.name for path in folder.iterdir()} - {made[0].name, f"{made[0].name}.json"}
    assert others == {"rundown-recent", "notes"}


def test_the_service_is_shown_where_backups_are() -> None:
    """The folder that they are written to, so that a missing one is an alarm."""
    (place,) = re.findall(r"nightly-backup.sh (/var/lib/(\S+))$", BACKUP.read_text(), re.MULTILINE)
    shown = (DEPLOY / "systemd/rundown.service.d/backups.conf").read_text().splitlines()
    assert f"StateDirectory={place[1]}" in shown
    assert f"Environment=RUNDOWN_BACKUPS={place[0]}" in shown
    api = yaml.safe_load((DEPLOY / "compose/compose.yaml").read_text())["services"]["api"]
    assert api["volumes"] == [f"/backup/rundown:{api['environment']['RUNDOWN_BACKUPS']}:ro"]


def test_every_layout_has_a_way_to_the_nightly_backup() -> None:
    """Of systemd, of compose by the line in the steps, and of Kubernetes: with a place that the image's user may write to."""
    script = "/opt/rundown/bin/nightly-backup.sh"
    unit, service = BACKUP.read_text(), (DEPLOY / "systemd/rundown.service").read_text()
    (place,) = re.findall(rf"^ExecStart={script} /var/lib/(\S+)$", unit, re.MULTILINE)
    assert f"StateDirectory=rundown {place}\n" in unit
    assert "User=rundown\n" in unit
    for line in ("Environment=RUNDOWN_DATABASE=sqlite:////var/lib/rundown/rundown.db", "DynamicUser=yes"):
        assert line in unit.splitlines()
        assert line in service.splitlines()
    image, readme = (DEPLOY / "Containerfile").read_text(), (DEPLOY / "README.md").read_text()
    assert f"COPY deploy/nightly-backup.sh {script}\n" in image
    (line,) = re.findall(r"docker compose run --rm -T -v (.*)$", readme, re.MULTILINE)
    assert shlex.split(line) == ["/backup/rundown:/backup", "--entrypoint", "nightly-backup.sh", "api", "/backup"]
    (user,) = re.findall(r"^USER (\d+)$", image, re.MULTILINE)
    assert f"install -d -m 700 -o {user} /backup/rundown\n" in readme
    (job,) = [one for one in manifests() if one["kind"] == "CronJob"]
    pod = job["spec"]["jobTemplate"]["spec"]["template"]["spec"]
    (container,) = pod["containers"]
    assert container["command"][0] == Path(script).name
    assert pod["securityContext"]["fsGroup"] == int(user)
    places = {one["mountPath"]: one["name"] for one in container["volumeMounts"] if not one.get("readOnly")}
    claims = {
        one["name"]: one["persistentVolumeClaim"]["claimName"] for one in pod["volumes"] if "persistentVolumeClaim" in one
    }
    claim = claims[places[container["command"][1]]]
    assert claim in [one["metadata"]["name"] for one in manifests() if one["kind"] == "PersistentVolumeClaim"]


def test_the_timer_is_right() -> None:
    if shutil.which("systemd-analyze") is None:
        pytest.skip("systemd-analyze is not installed")
    timer = DEPLOY / "systemd" / "rundown-backup.timer"
    told = subprocess.run(["systemd-analyze", "verify", str(timer)], capture_output=True, text=True, check=False).stderr
    assert [line for line in told.splitlines() if "rundown" in line and "is not executable" not in line] == []
    (when,) = re.findall(r"^OnCalendar=(.*)$", timer.read_text(), re.MULTILINE)
    subprocess.run(["systemd-analyze", "calendar", when], check=True, capture_output=True)
