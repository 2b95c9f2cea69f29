"""The set-up that docs/opcua.md prints: its certificate, its key and its settings serve a client that encrypts."""

import re
import shutil
from pathlib import Path

import pytest

from service.configuration.settings import Settings
from service.opcua.serving import OPENING, OpcUaServing
from storage.database.engine import Database
from tests.paths import ROOT
from tests.plant import wait_until
from tests.ports import free_port
from tests.printed_commands import run_printed
from tests.programs import program
from tests.service.opcua.certificates import Authority
from tests.service.opcua.second_stack import second_stack
from tests.service.opcua.served_plants import CLIENT, SECURITY

INSTALL, SERVE = "pip install", "rundown serve"
"""Begins of the lines that are not run: everything is installed, and the server is begun here, at a port that is free."""


def test_what_is_printed_serves_a_client_that_encrypts(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    program("openssl")
    printed = re.search(r"```sh\n(.*?)```", (ROOT / "docs" / "opcua.md").read_text(encoding="utf-8"), re.DOTALL)
    assert printed is not None
    lines = printed[1].splitlines()
    assert [one.split("'")[0].strip() for one in lines if one.startswith((INSTALL, SERVE))] == [INSTALL, SERVE]
    told, environment = run_printed((one for one in lines if not one.startswith((INSTALL, SERVE))), tmp_path)
    monkeypatch.chdir(tmp_path)
    for name, value in environment.items():
        monkeypatch.setenv(name, value)
    assert environment["RUNDOWN_OPCUA_LISTEN"] == "opc.tcp://0.0.0.0:4840"
    endpoint = f"opc.tcp://127.0.0.1:{free_port()}"
    (tmp_path / "clients").mkdir()
    clients = Authority(tmp_path / "clients")
    shutil.copy(clients.trusted / "authority.pem", "trusted")
    certificate, key = clients.issue("client", CLIENT)
    password = re.search(r"^rundown_\S+$", told, re.MULTILINE)
    assert password is not None, told
    serving = OpcUaServing(Database("sqlite:///rundown.db"), Settings(opcua_listen=endpoint))
    serving.start()
    try:
        wait_until(lambda: serving.trouble != OPENING)
        assert serving.trouble is None
        who = {"user": "control-room", "password": password[0], "security": SECURITY, "application": CLIENT}
        with second_stack(endpoint, tmp_path, certificate=str(certificate), key=str(key), **who) as client:
            assert "Rundown" in client.ask("browse", node="i=85")["names"]
    finally:
        serving.stop()
