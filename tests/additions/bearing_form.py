"""Adds a form of bearing to a copy of the packages, as docs/developers.md says: a module, and an entry in the registry."""

from tests.additions.package_copy import PackageCopy

REGISTRY = "estimator/bearings/registry.py"


def add_form(copy: PackageCopy, *, module: str, form: str, text: str) -> None:
    """Write the module with the form into a copy. module: its name. form: name of its class. text: its source."""
    copy.write(f"estimator/bearings/{module}.py", text)
    copy.insert(REGISTRY, "FORMS = (", f"{form}, ")
    imported = "from estimator.bearings.model import BearingForm, OwnParameter\n"
    copy.insert(REGISTRY, imported, f"from estimator.bearings.{module} import {form}\n")
