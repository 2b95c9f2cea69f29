"""What an error of the database says, and whom it concerns."""

from sqlalchemy.exc import DataError, DBAPIError, IntegrityError, TimeoutError

from storage.damage import is_of_a_part
from storage.leases import NotHeld


def concerns_all(error: BaseException) -> bool:
    """Whether an error is the database's, or of who may write to it: whatever else is tried now would fail as well. Damaged
    pages hinder only who needs them.
    """
    of_one = isinstance(error, DataError | IntegrityError) or is_of_a_part(error)
    return isinstance(error, NotHeld | DBAPIError | TimeoutError) and not of_one


def words(error: Exception) -> str:
    """What the database said, or what said that there is none."""
    return str(getattr(error, "orig", None) or error)
