"""The error of a file of waveforms that cannot be read, wholly or from some place on."""


class FileTrouble(Exception):
    """name: a condition. What was delivered before it was raised is good."""

    def __init__(self, name: str, detail: str) -> None:
        super().__init__(detail)
        self.name = name
        self.detail = detail


def require_columns(wanted: list[str], there: list[str]) -> None:
    """Raise FileTrouble for columns that are not there."""
    missing = [column for column in wanted if column not in there]
    if missing:
        raise FileTrouble("missing_column", f"no {', '.join(missing)}; there are {', '.join(there[:50]) or 'none'}")
