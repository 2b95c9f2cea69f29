"""Registries hold all that is declared: a forgotten name would be found by nobody, as the rest works without it."""

from importlib import import_module
from pathlib import Path
from types import ModuleType

from fastapi import APIRouter

from estimator.bearings.defaults import FormDefaults
from estimator.bearings.registry import CONSTANT, FORMS
from service.api import application
from service.delivery.channel_kind import ChannelKind
from service.delivery.channels import CHANNEL_KINDS
from service.monitoring.rules.finding_rule import FindingRule
from service.monitoring.rules.finding_rules import FINDING_RULES
from tests.paths import ROOT


def modules(folder: str) -> list[ModuleType]:
    """Import all modules of a folder and of those in it."""
    paths = [path.relative_to(ROOT) for path in sorted((ROOT / folder).rglob("*.py")) if path.stem != "__init__"]
    assert paths, folder
    return [import_module(".".join(Path(path).with_suffix("").parts)) for path in paths]


def test_every_channel_kind_is_registered() -> None:
    declared = [one for module in modules("service/delivery") for one in vars(module).values() if isinstance(one, ChannelKind)]
    assert [one.kind for one in declared if one not in CHANNEL_KINDS] == [], "name it in service/delivery/channels.py"


def test_every_form_of_a_bearing_is_registered() -> None:
    modules("estimator/bearings")
    forms = {one for one in FormDefaults.__subclasses__() if one.__module__.startswith("estimator.")}
    assert forms - {*FORMS, type(CONSTANT)} == set(), "name it in FORMS of estimator/bearings/registry.py"


def test_every_finding_rule_is_registered() -> None:
    groups = [one for module in modules("service/monitoring/rules") for one in vars(module).values() if isinstance(one, tuple)]
    declared = [one for group in groups for one in group if isinstance(one, FindingRule)]
    assert [one.kind for one in declared if one not in FINDING_RULES] == [], "name its group in finding_rules.py"


def test_every_router_of_the_api_is_served() -> None:
    served = {one.path.removeprefix(application.PREFIX) for one in application.every_operation()}
    routers = {
        f"{module.__name__}.{name}": one
        for module in modules("service/api")
        for name, one in vars(module).items()
        if isinstance(one, APIRouter) and module is not application
    }
    assert len(routers) > 30
    paths = {name: {getattr(route, "path", "") for route in one.routes} for name, one in routers.items()}
    assert {name: own - served for name, own in paths.items() if own - served} == {}, "name it in service/api/application.py"
