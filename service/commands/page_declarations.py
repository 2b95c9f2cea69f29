"""Writes the page's declarations of findings and delivery channels: TypeScript made from the Python declarations.

`python -m service.commands.page_declarations dashboard/src/declarations` writes the files anew; they are committed.
"""

import json
import sys
from collections.abc import Mapping
from pathlib import Path

from service.delivery.channels import CHANNEL_KINDS
from service.monitoring.finding_rules import LIMITED_RULES

FINDINGS, CHANNELS = "findings.ts", "channels.ts"
HEAD = "// Written by `python -m service.commands.page_declarations` from {source}; not to be changed here.\n\n"


def documents() -> Mapping[str, str]:
    """Return the text of each file by its name."""
    return {FINDINGS: _findings(), CHANNELS: _channels()}


def write(folder: Path) -> None:
    """Write all files into a folder."""
    for name, text in documents().items():
        (folder / name).write_text(text, encoding="utf-8")


def _findings() -> str:
    names = ", ".join(json.dumps(name) for name in LIMITED_RULES)
    quantities = "".join(f"  {name}: {json.dumps(rule.quantities)},\n" for name, rule in LIMITED_RULES.items())
    return (
        HEAD.format(source="service/monitoring/finding_rules.py")
        + "/** Kinds of findings that have limits of their own. */\n"
        + f"export const RULES = [{names}] as const;\n\n"
        + "export type RuleName = (typeof RULES)[number];\n\n"
        + "/** Quantities that the limits of each kind may name. */\n"
        + f"export const QUANTITIES: Record<RuleName, readonly string[]> = {{\n{quantities}}};\n"
    )


def _channels() -> str:
    kinds = "".join(
        f"  {{ kind: {json.dumps(one.kind)}, title: {json.dumps(one.title, ensure_ascii=False)}, "
        f"reports: {json.dumps(one.reporting)} }},\n"
        for one in CHANNEL_KINDS
    )
    addresses = ", or ".join(dict.fromkeys(one.address for one in CHANNEL_KINDS if one.address is not None))
    without = ", ".join(one.kind for one in CHANNEL_KINDS if one.address is None)
    words = f"{addresses}; none for {without}" if without else addresses
    return (
        HEAD.format(source="service/delivery/channels.py")
        + "/** Ways in which people and programs are told of alerts; reports: whether reports of machines go there. */\n"
        + f"export const CHANNELS = [\n{kinds}] as const;\n\n"
        + "/** Forms of their addresses, in words. */\n"
        + f"export const ADDRESS_FORMS = {json.dumps(words, ensure_ascii=False)};\n"
    )


if __name__ == "__main__":
    write(Path(sys.argv[1]))
