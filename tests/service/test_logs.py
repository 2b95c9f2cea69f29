"""Logs as JSON: an object a line, whatever is logged."""

import json
import logging

from service.logs import JsonLines


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
