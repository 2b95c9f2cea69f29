"""A site's own texts of findings: a YAML file that is read whole, or refused whole with every wrong text.

```yaml
misalignment:
  at_next_stop: ["Call the alignment crew (tel. 417) for coupling {id}; sheet A-12"]
```

Each finding has `what`, one text, and lists of texts; what is left out stays as the service has it. A seal that has changed is
found as a bearing is, and has texts of its own below `seal`. Texts hold for readers of every language; below the code of a
language (`de:`) they hold for that one alone.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from estimator.close_matches import did_you_mean
from formats.files.document_files import UnreadableFile, read_yaml
from service.monitoring.rules.drift_rule import RATE_RULE
from service.monitoring.rules.finding_catalogue import rule_of_kind
from service.monitoring.rules.finding_rules import FINDING_RULES
from service.wording.finding_texts import LISTS, MOST_TEXTS, FindingTexts, TextsWrong
from service.wording.language import ENGLISH, LANGUAGES, SENTENCES, Language, Locale

OF_ELEMENTS = {element: one.kind for one in FINDING_RULES for element in one.texts_of_elements}
"""Kinds of elements of which a finding has texts of their own, with that finding: a changed seal is found as a bearing."""
KINDS = (*(one.kind for one in FINDING_RULES), RATE_RULE.kind, *OF_ELEMENTS)
"""Kinds of findings, and of elements, that have texts."""
FIELDS = ("what", *LISTS)


Written = Mapping[str, Mapping[str, Any]]
"""Texts that a site has written: by kind of finding, by name."""


@dataclass(frozen=True)
class SiteTexts:
    """Texts of findings in a language: what a site has written, the service's own for all else.

    written: by the code of the language that they are for; empty: for all.
    """

    written: Mapping[str, Written] = field(default_factory=dict)
    language: Language = ENGLISH

    def in_language(self, language: Language) -> "SiteTexts":
        """Return the texts for readers of a language."""
        return self if language == self.language else replace(self, language=language)

    def of(self, kind: str, element_kind: str = "") -> FindingTexts:
        """Return the texts of a kind of finding. Raises KeyError when there is no such kind.

        element_kind: kind of the element that they are said of.
        """
        texts = rule_of_kind(kind).texts_in(self.language, element_kind)
        written_as = element_kind if OF_ELEMENTS.get(element_kind) == kind else kind
        for code in ("", self.language.code):
            own = self.written.get(code, {}).get(written_as)
            texts = texts if own is None else replace(texts, **own)
        return texts


def read_texts(file: str, locale: Locale = "en") -> SiteTexts:
    """Read a site's texts; those of the service where no file is named. locale: language of readers. Raises TextsWrong."""
    if not file:
        return SiteTexts(language=Language(locale))
    try:
        content = read_yaml(Path(file))
    except UnreadableFile as error:
        raise TextsWrong(f"finding texts: {error}") from error
    try:
        return SiteTexts(parsed_texts(content), Language(locale))
    except TextsWrong as error:
        raise TextsWrong(f"finding texts of {file}:\n{error}") from error


def parsed_texts(content: Any) -> Mapping[str, Written]:
    """Return the texts of a decoded file, by language. Raises TextsWrong, which names all that is wrong."""
    if not isinstance(content, dict):
        raise TextsWrong("  the file must have the kinds of findings at its top, such as misalignment")
    by_language: dict[str, Any] = {one.code: content[one.code] for one in LANGUAGES if one.code in content}
    parts: dict[str, Any] = {"": {kind: said for kind, said in content.items() if kind not in by_language}, **by_language}
    problems: list[str] = []
    found: dict[str, Written] = {}
    for code, said in parts.items():
        if not isinstance(said, dict):
            problems.append(f"{code}: must have the kinds of findings below it, such as misalignment")
            continue
        found[code], wrong = _parsed(said)
        problems += [f"{code}.{one}" if code else one for one in wrong]
    if problems:
        raise TextsWrong("\n".join(f"  {one}" for one in problems))
    return found


def _parsed(content: Mapping[Any, Any]) -> tuple[Written, list[str]]:
    """Return the texts by kind of finding, and what is wrong."""
    problems: list[str] = []
    found: dict[str, Mapping[str, Any]] = {}
    for kind, said in content.items():
        if kind not in KINDS:
            known = f"; there are {', '.join(KINDS)}, and the languages {', '.join(SENTENCES)}"
            problems.append(f"{kind}: there is no such finding{did_you_mean(str(kind), KINDS)}{known}")
            continue
        wrong = list(_wrong_fields(said))
        misformed = {where for where, _ in wrong}
        usable = said.items() if isinstance(said, dict) else ()
        found[kind] = {name: one if name == "what" else tuple(one) for name, one in usable if str(name) not in misformed}
        rule = rule_of_kind(OF_ELEMENTS.get(kind, kind))
        element_kind = kind if kind in OF_ELEMENTS else ""
        wrong += rule.problems(replace(rule.texts_in(ENGLISH, element_kind), **found[kind]))
        problems += [f"{kind}.{where}: {message}" if where else f"{kind}: {message}" for where, message in wrong]
    return found, problems


def _wrong_fields(said: Any) -> list[tuple[str, str]]:
    """Return the faults in the form of a finding's texts, as (field, message)."""
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
