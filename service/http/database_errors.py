"""Categories of a database's errors, for the answers over HTTP."""

from sqlalchemy.exc import DataError, DBAPIError

from estimator.errors import Damaged, DomainError, Invalid, Unavailable
from storage.database.damage import error_text, is_damage
from storage.database.errors import error_outline


def categorized(error: DBAPIError) -> DomainError:
    """Return the error to tell instead of a database's: unsuitable input, damage, or no answer."""
    if isinstance(error, DataError):
        return Invalid(f"the database cannot hold or look for that: {error.orig}")
    if is_damage(error):
        return Damaged(f"what is stored is damaged, and cannot be read: {error_text(error)}")
    return Unavailable(f"the database does not answer: {error_outline(error)}")
