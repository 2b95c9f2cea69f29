"""Formats the service's log on standard error: lines for people, or one JSON object a line for a log collector."""

import logging
import sys
from datetime import UTC, datetime
from typing import Literal

import msgspec

from storage.encoding.text import plain_lines

LogFormat = Literal["text", "json"]

TEXT = "%(asctime)s %(levelname)s %(name)s: %(message)s"


class TextLines(logging.Formatter):
    """Formatter of lines for people, with control characters of logged data escaped."""

    def format(self, record: logging.LogRecord) -> str:
        """Return a line, with those of a traceback."""
        return plain_lines(super().format(record))


class JsonLines(logging.Formatter):
    """Formatter of a JSON object per record: at (RFC 3339, UTC), level, logger, message, thread, exception."""

    def format(self, record: logging.LogRecord) -> str:
        """Return the record as JSON in one line."""
        entry = {
            "at": datetime.fromtimestamp(record.created, UTC).isoformat(timespec="milliseconds").replace("+00:00", "Z"),
            "level": record.levelname,
            "logger": record.name,
            "message": record.getMessage(),
            "thread": record.threadName,
        }
        if record.exc_info:
            entry["exception"] = self.formatException(record.exc_info)
        return msgspec.json.encode(entry).decode()


def log_to_terminal(level: str, log_format: LogFormat = "text") -> None:
    """Configure logging to standard error."""
    handler = logging.StreamHandler(sys.stderr)
    handler.setFormatter(JsonLines() if log_format == "json" else TextLines(TEXT))
    logging.basicConfig(level=level.upper(), handlers=[handler])
    logging.getLogger("alembic").setLevel(logging.WARNING)
