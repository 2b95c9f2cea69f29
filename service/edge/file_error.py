"""The error of a file of waveforms that cannot be read, completely or from some place on."""


class InputFileError(Exception):
    """A file cannot be read further; samples delivered before are good. name: the condition, see `service.edge.condition`."""

    def __init__(self, name: str, detail: str) -> None:
        super().__init__(detail)
        self.name = name
        self.detail = detail


def require_columns(wanted: list[str], there: list[str]) -> None:
    """Raise InputFileError unless all columns exist."""
    missing = [column for column in wanted if column not in there]
    if missing:
        raise InputFileError("missing_column", f"no {', '.join(missing)}; there are {', '.join(there[:50]) or 'none'}")
