"""Leases are what the database makes of them: these tests run on both kinds, as those of the store do."""

from tests.storage.conftest import databases, empty_template, kind, plant_template

__all__ = ["databases", "empty_template", "kind", "plant_template"]
