"""Categories of errors: each base class is one, and every error that is told to whoever asked derives from one of them.

How a category is told, such as by which status of HTTP, is up to whoever answers.
"""

from collections.abc import Sequence
from typing import ClassVar


class DomainError(Exception):
    """Base of all categories; no error derives from it directly."""

    retry_after_s: ClassVar[int | None] = None
    """When it makes sense to ask again [s]; None where nobody knows."""

    @property
    def detail(self) -> str:
        """Describe what is wrong, where, and what would be right."""
        return str(self.args[0]) if self.args else str(self)

    @property
    def field_errors(self) -> Sequence[tuple[str, str]]:
        """Name each wrong field of what was given, and say what is wrong with it."""
        return ()


class Invalid(DomainError, ValueError):
    """Input that cannot be right, or of which nothing can be made."""


class Missing(DomainError, LookupError):
    """Something asked for that is not there; the error's argument names it."""

    subject: str
    """A word for what it is: `machine`."""

    @property
    def detail(self) -> str:
        """Describe what is not there."""
        return f"no {self.subject} {super().detail}"


class Conflict(DomainError, ValueError):
    """A request that is forbidden by what is there."""


class Gone(DomainError):
    """Something asked for that was there once, and is deleted."""


class Outdated(DomainError):
    """A change of something that is no longer as it was read."""


class Unconditional(DomainError):
    """A change that does not say which state it replaces, and has to."""


class LimitReached(DomainError):
    """As much is under way as may be; later there is room again."""


class Damaged(DomainError, ValueError):
    """Stored data that cannot be read."""

    @property
    def detail(self) -> str:
        """Describe what cannot be read, and what to do."""
        return f"{super().detail}; look at the disk, and restore a backup"


class Unavailable(DomainError, RuntimeError):
    """A part that is needed does not work at present."""
