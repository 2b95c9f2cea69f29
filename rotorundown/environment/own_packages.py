"""Check that the packages beside this one are Rundown's own: a user's `storage.py` would hide one of them."""

from importlib.util import find_spec
from pathlib import Path

OWN_PACKAGES = ("estimator", "formats", "service", "storage")


def require_own_packages() -> None:
    """Raise ImportError, in one line, where another file or package hides one of Rundown's."""
    home = Path(__file__).resolve().parents[2]
    for name in OWN_PACKAGES:
        spec = find_spec(name)
        origin = None if spec is None else spec.origin
        if origin is None:
            raise ImportError(f"rotorundown needs its package '{name}', which is not installed: install rotorundown anew")
        if Path(origin).resolve().parent.parent != home:
            hiding = Path(origin).parent if Path(origin).name == "__init__.py" else origin
            raise ImportError(f"{hiding} hides rotorundown's own package '{name}': rename that, or start Python elsewhere")
