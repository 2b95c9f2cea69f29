"""docs/edge.md says what the agent takes and what it says of itself."""

import re

import yaml

from service.edge.condition import CONDITIONS
from service.edge.configuration import EdgeConfiguration
from service.edge.waveform_message import _HEADER
from tests.paths import ROOT

PAGE = (ROOT / "docs" / "edge.md").read_text()


def test_the_configuration_on_the_page_is_one_for_the_example() -> None:
    (block,) = re.findall(r"```yaml\n(.*?)```", PAGE, re.DOTALL)
    shown = EdgeConfiguration.model_validate(yaml.safe_load(block))
    described = yaml.safe_load((ROOT / "examples" / f"{shown.machine}.yaml").read_text())
    assert {channel.probe for channel in shown.channels} <= {probe["id"] for probe in described["probes"]}
    assert shown.speed_range.model_dump() == described["speed_range"]
    assert shown.plant == described["plant"]


def test_every_condition_is_on_the_page() -> None:
    rows = [line.split("|")[1] for line in PAGE.splitlines() if line.startswith("| `")]
    named = {name for row in rows for name in re.findall(r"`(\w+)`", row)}
    assert set(CONDITIONS) <= named


def test_the_header_of_a_message_has_the_documented_length() -> None:
    assert _HEADER.size == 56
