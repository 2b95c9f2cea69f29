"""Categories of errors: each base class is a category, and every error reported to a caller derives from one.

How a category is reported, such as by a status of HTTP, is decided where the answer is made.
"""

from collections.abc import Sequence
from typing import ClassVar


class DomainError(Exception):
    """Base of all categories; no error derives from it directly."""

    retry_after_s: ClassVar[int | None] = None
    """Time after which it makes sense to ask again [s]; None where it is unknown."""
    remedy: ClassVar[str]
    """Remedy of any error of the category, where its message does not say more; each category states it."""

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

    remedy: ClassVar[str] = "Mend what the message names, and send it again: the same input will not be taken later either."


class Unreadable(DomainError, ValueError):
    """Raised when bytes cannot be read as what they are said to be."""

    remedy: ClassVar[str] = "Send it in the form that the message names; look for a cut-off file or a wrong encoding."


class Oversized(DomainError, ValueError):
    """Raised when more comes at once than is taken."""

    remedy: ClassVar[str] = "Send it in smaller parts, within the size that the message names."


class Missing(DomainError, LookupError):
    """Raised when the object asked for does not exist; the error's argument names it."""

    remedy: ClassVar[str] = (
        "List what there is, and look for a typing error; objects outside of your plants are answered the same way."
    )

    subject: str
    """Word for the kind of object: `machine`."""

    @property
    def detail(self) -> str:
        """State which object does not exist."""
        return f"no {self.subject} {super().detail}"


class Conflict(DomainError, ValueError):
    """Raised when the present state forbids the request."""

    remedy: ClassVar[str] = "Read the object again: what the message names has to be ended, undone or waited for before."


class NotAllowed(DomainError):
    """Raised when the caller may not do this."""

    remedy: ClassVar[str] = "Ask with a key or login of the role that the message names, or ask the administrator for it."


class Gone(DomainError):
    """Raised when the object asked for existed once, and is deleted."""

    remedy: ClassVar[str] = (
        "It cannot be had back from here: use a newer object, or a backup; keep more with the retention settings."
    )


class Outdated(DomainError):
    """Raised when the object to be changed is no longer as it was read."""

    remedy: ClassVar[str] = "Read the object again, look whether the change is still wanted, and send it with the new ETag."


class Unconditional(DomainError):
    """Raised when a change does not say which state it replaces, and has to."""

    remedy: ClassVar[str] = "Read the object first, and send its ETag as If-Match with the change."


class LimitReached(DomainError):
    """Raised when as much is under way as may be; later there is room again."""

    remedy: ClassVar[str] = "Wait as long as Retry-After says, and ask again; nothing was lost."


class Damaged(DomainError, ValueError):
    """Raised when a stored object cannot be read."""

    remedy: ClassVar[str] = "Look at the disk, and restore a backup (docs/runbook.md); the rest of the data stays readable."

    @property
    def detail(self) -> str:
        """State what cannot be read, and what to do."""
        return f"{super().detail}; look at the disk, and restore a backup"


class Unavailable(DomainError, RuntimeError):
    """Raised when a part that is needed does not work at present."""

    remedy: ClassVar[str] = (
        "Ask again in a minute; where it lasts, `rundown doctor` and the health name the part that does not work."
    )
