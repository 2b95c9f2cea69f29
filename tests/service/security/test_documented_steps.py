"""The steps that docs/security.md prints: keys, certificates, and the rules of the zenoh network, which read as settings."""

import re
from pathlib import Path

import pytest

from service.configuration.settings import Settings
from service.messaging.access_control import StreamSecurity
from tests.paths import ROOT
from tests.printed_commands import run_printed
from tests.programs import program

FOLDER = "/etc/rundown"
ASKS = "curl "
"""Begin of the line that asks a service, which is not there."""


def test_the_steps_run_as_printed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    program("openssl")
    page = (ROOT / "docs" / "security.md").read_text(encoding="utf-8").replace(FOLDER, str(tmp_path / "etc"))
    steps, settings = re.findall(r"^```sh\n(.*?)^```", page, re.MULTILINE | re.DOTALL)[:2]
    (access,) = re.findall(r"^```yaml\n(sources:.*?)^```", page, re.MULTILINE | re.DOTALL)
    (tmp_path / "deploy").symlink_to(ROOT / "deploy")
    run_printed([f"deploy/certificates.sh etc {name}" for name in ("authority", "api")], tmp_path)  # the API's, a site's own
    told, _ = run_printed((one for one in steps.splitlines() if not one.startswith(ASKS)), tmp_path)
    assert len(re.findall(r"^rundown_\S+$", told, re.MULTILINE)) == 2, "a key of each person and program"
    (tmp_path / "etc" / "access.yaml").write_text(access)
    _, environment = run_printed((one for one in settings.splitlines() if one.startswith("export")), tmp_path)
    for name, value in environment.items():
        monkeypatch.setenv(name, value)
    settings_read = Settings()
    assert settings_read.zenoh_listen == ["tls/0.0.0.0:7447"]
    security = StreamSecurity.of(settings_read)
    assert security is not None
    assert security.access is not None
    assert set(security.access.sources) == {"edge-7"}
    for file in (security.authority, security.certificate, security.key):
        assert Path(file).read_text().startswith("-----BEGIN")
    assert (tmp_path / "etc" / "zenoh" / "edge-7.crt").exists()
