"""Categories of errors: each base class is one, and every error that is reported to a caller derives from one of them.

How a category is reported, such as by a status of HTTP, is decided where the answer is made.
"""

from collections.abc import Sequence
from typing import ClassVar


class DomainError(Exception):
    """Base of all categories; no error derives from it directly."""

    retry_after_s: ClassVar[int | None] = None
    """Time after which it makes sense to ask again [s]; None where it is unknown."""

    @property
    def detail(self) -> str:
        """State what is wrong, where, and what would be right."""
        return str(self.args[0]) if self.args else str(self)

    @property
    def field_errors(self) -> Sequence[tuple[str, str]]:
        """Return each wrong field of the input with what is wrong with it."""
        return ()


class Invalid(DomainError, ValueError):
    """Raised when the input cannot be right, or nothing can be made of it."""


class Unreadable(DomainError, ValueError):
    """Raised when bytes cannot be read as what they are said to be."""


class Oversized(DomainError, ValueError):
    """Raised when more comes at once than is taken."""


class Missing(DomainError, LookupError):
    """Raised when the object asked for does not exist; the error's argument names it."""

    subject: str
    """Word for the kind of object: `machine`."""

    @property
    def detail(self) -> str:
        """State which object does not exist."""
        return f"no {self.subject} {super().detail}"


class Conflict(DomainError, ValueError):
    """Raised when the present state forbids the request."""


class NotAllowed(DomainError):
    """Raised when the caller may not do this."""


class Gone(DomainError):
    """Raised when the object asked for existed once, and is deleted."""


class Outdated(DomainError):
    """Raised when the object to be changed is no longer as it was read."""


class Unconditional(DomainError):
    """Raised when a change does not say which state it replaces, and has to."""


class LimitReached(DomainError):
    """Raised when as much is under way as may be; later there is room again."""


class Damaged(DomainError, ValueError):
    """Raised when a stored object cannot be read."""

    @property
    def detail(self) -> str:
        """State what cannot be read, and what to do."""
        return f"{super().detail}; look at the disk, and restore a backup"


class Unavailable(DomainError, RuntimeError):
    """Raised when a part that is needed does not work at present."""
