"""Logs as JSON: an object a line, whatever is logged, in each process that stays."""

import json
import logging
from pathlib import Path

from service.configuration.log_format import JsonLines
from tests.end_to_end.processes import process, until
from tests.ports import free_port


def test_a_record_is_one_line_with_its_exception() -> None:
    try:
        raise ValueError("two\nlines")
    except ValueError as error:
        record = logging.LogRecord(
            "service.x", logging.ERROR, __file__, 1, 'a "%s" ü', ("b\nc",), (type(error), error, error.__traceback__)
        )
    line = JsonLines().format(record)
    assert "\n" not in line
    told = json.loads(line)
    assert (told["level"], told["logger"], told["message"]) == ("ERROR", "service.x", 'a "b\nc" ü')
    assert told["at"].endswith("Z")
    assert told["exception"].endswith("ValueError: two\nlines")


def test_a_router_logs_as_the_settings_say(tmp_path: Path) -> None:
    log = tmp_path / "router.log"
    endpoint = f"tcp/127.0.0.1:{free_port()}"
    with process(log, "router", "--listen", endpoint, RUNDOWN_LOG_FORMAT="json"):
        until(lambda: endpoint in log.read_text(), within_s=30, what="the router listens")
    told = [json.loads(line) for line in log.read_text().splitlines()]
    assert told[0]["message"] == f"routing on {endpoint}"
