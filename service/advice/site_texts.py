"""A site's own texts of findings: a YAML file that is read whole, or refused whole with every wrong text.

```yaml
misalignment:
  at_next_stop: ["Call the alignment crew (tel. 417) for coupling {id}; sheet A-12"]
```

Each finding has `what`, one text, and lists of texts; what is left out stays as the service has it.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from estimator.close_matches import did_you_mean
from service.configuration.document_files import UnreadableFile, read_yaml
from service.monitoring.finding_rules import FINDING_RULES, RATE_RULE, told_rule
from service.wording.finding_texts import LISTS, MOST_TEXTS, FindingTexts, TextsWrong

KINDS = (*(one.kind for one in FINDING_RULES), RATE_RULE.kind)
"""Kinds of findings that have texts."""
FIELDS = ("what", *LISTS)


@dataclass(frozen=True)
class SiteTexts:
    """Texts that a site has written, by kind of finding; the service's own for all others."""

    own: Mapping[str, FindingTexts] = field(default_factory=dict)

    def of(self, kind: str) -> FindingTexts:
        """Return the texts of a kind of finding. Raises KeyError when there is no such kind."""
        return self.own.get(kind) or told_rule(kind).texts


def read_texts(file: str) -> SiteTexts:
    """Read a site's texts; those of the service where no file is named. Raises TextsWrong."""
    if not file:
        return SiteTexts()
    try:
        content = read_yaml(Path(file))
    except UnreadableFile as error:
        raise TextsWrong(f"finding texts: {error}") from error
    try:
        return SiteTexts(parsed_texts(content))
    except TextsWrong as error:
        raise TextsWrong(f"finding texts of {file}:\n{error}") from error


def parsed_texts(content: Any) -> Mapping[str, FindingTexts]:
    """Return the texts of a decoded file. Raises TextsWrong, which names all that is wrong."""
    if not isinstance(content, dict):
        raise TextsWrong("  the file must have the kinds of findings at its top, such as misalignment")
    problems: list[str] = []
    found: dict[str, FindingTexts] = {}
    for kind, said in content.items():
        if kind not in KINDS:
            problems.append(f"{kind}: there is no such finding{did_you_mean(str(kind), KINDS)}; there are {', '.join(KINDS)}")
            continue
        wrong = list(_wrong_fields(said))
        problems += [f"{kind}.{where}: {message}" if where else f"{kind}: {message}" for where, message in wrong]
        if not wrong:
            rule = told_rule(kind)
            written: dict[str, Any] = {name: one if name == "what" else tuple(one) for name, one in said.items()}
            texts = replace(rule.texts, **written)
            problems += [f"{kind}.{where}: {message}" for where, message in rule.problems(texts)]
            found[kind] = texts
    if problems:
        raise TextsWrong("\n".join(f"  {one}" for one in problems))
    return found


def _wrong_fields(said: Any) -> list[tuple[str, str]]:
    """Return what is wrong with the form of a finding's texts, as (field, message)."""
    if not isinstance(said, dict):
        return [("", f"must have texts by name: {', '.join(FIELDS)}")]
    found = []
    for name, one in said.items():
        if name not in FIELDS:
            found.append((str(name), f"there is no such text{did_you_mean(str(name), FIELDS)}; there are {', '.join(FIELDS)}"))
        elif name == "what" and not isinstance(one, str):
            found.append((name, "must be one text"))
        elif name != "what" and not _is_list_of_texts(one):
            found.append((name, f"must be a list of 1 to {MOST_TEXTS} texts"))
    return found


def _is_list_of_texts(value: Any) -> bool:
    return isinstance(value, list) and 1 <= len(value) <= MOST_TEXTS and all(isinstance(one, str) for one in value)
