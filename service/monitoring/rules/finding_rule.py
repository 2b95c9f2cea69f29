"""Declaration of how findings are reported: the rule by which an alert is raised, and what is said of a kind of finding."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from service.monitoring.rules.limit_rule import LimitQuantity, Rule
from service.wording.described_finding import DescribedFinding
from service.wording.finding_texts import LISTS, FindingTexts
from service.wording.finding_words import no_questions, size_words
from service.wording.language import ENGLISH, LANGUAGES, Language, Locale, require_every_language

if TYPE_CHECKING:
    from estimator.diagnosis.finding_kind import ElementKind


@dataclass(frozen=True)
class AlertRule:
    """Rule by which alerts are raised. Raises ValueError when its parts contradict each other.

    limits: the defaults; None when the finding has no size: it is then always an alert, never a danger. quantities: those that
    its levels may name. deviations: kinds of elements whose deviations of single parameters are also measured by it. elements:
    kinds of elements that it concerns besides those of its findings. mended_by_balancing: kinds of elements at which balancing
    mends what it reports.
    """

    name: str
    limits: Rule | None = None
    quantities: tuple[LimitQuantity, ...] = ()
    deviations: tuple["ElementKind", ...] = ()
    elements: tuple["ElementKind", ...] = ()
    mended_by_balancing: tuple["ElementKind", ...] = ()

    def __post_init__(self) -> None:
        if (self.limits is None) != (not self.quantities):
            raise ValueError(f"alert rule '{self.name}' needs both limits and quantities that they may name, or neither")
        if self.limits is not None:
            self.require_quantities(self.limits)

    def require_quantities(self, rule: Rule) -> None:
        """Raise ValueError for a level that names a quantity which this rule does not have."""
        for level_name, level in (("alert", rule.alert), ("danger", rule.danger)):
            for quantity in level.named if level is not None else ():
                if quantity not in self.quantities:
                    raise ValueError(
                        f"{level_name}.{quantity} is no limit of {self.name}: it has {', '.join(self.quantities)}"
                    )


Words = Callable[[DescribedFinding], Mapping[str, str]]
"""Function that returns what stands in the places of a finding's own texts, by name; `size` is one of them."""


@dataclass(frozen=True)
class FindingRule:
    """Declaration of how one kind of finding is reported. Raises ValueError when a part is missing or wrong.

    names: by language; English may be left out where it is the kind with spaces. texts: what is said of it, by language, which
    a site may replace. words: what stands in its places. texts_of_elements: texts of elements of another kind, such as a seal,
    by that kind. places: those beside `PLACES`.
    force: the derived value of the element that is its force [N], such as `misalignment_force`; required when the rule's
    levels may name a force. open_questions: what the numbers of a finding leave open, beside what its texts say.
    """

    kind: str
    rule: AlertRule
    names: Mapping[Locale, str]
    texts: Mapping[Locale, FindingTexts]
    words: Words = size_words
    texts_of_elements: Mapping[str, Mapping[Locale, FindingTexts]] = field(default_factory=dict)
    places: tuple[str, ...] = ()
    force: str | None = None
    open_questions: Callable[[DescribedFinding], Sequence[str]] = no_questions

    def __post_init__(self) -> None:
        if "force" in self.rule.quantities and self.force is None:
            raise ValueError(f"finding '{self.kind}' can have a limit for a force, and does not say which value that is")
        require_every_language(f"name of finding '{self.kind}'", {"en": self.kind, **self.names})
        require_every_language(f"texts of finding '{self.kind}'", self.texts)
        for element_kind, texts in self.texts_of_elements.items():
            require_every_language(f"texts of finding '{self.kind}' of a {element_kind}", texts)
        for language in LANGUAGES:
            for element_kind in ("", *self.texts_of_elements):
                where = "" if language == ENGLISH else f" ({language.code})"
                self._require_texts(self.texts_in(language, element_kind), where)

    def texts_in(self, language: Language, element_kind: str = "") -> FindingTexts:
        """Return the texts in a language. element_kind: kind of the element that they are said of."""
        return self.texts_of_elements.get(element_kind, self.texts)[language.code]

    def name_in(self, language: Language) -> str:
        """Return its name in a language."""
        return self.names.get(language.code) or self.kind.replace("_", " ")

    @property
    def can_be_danger(self) -> bool:
        """Return whether it has a danger limit unless a site sets others."""
        return self.rule.limits is not None and self.rule.limits.danger is not None

    def problems(self, texts: FindingTexts) -> list[tuple[str, str]]:
        """Return what is wrong with texts of it, as (field, message)."""
        needed = [one for one in ("id", "size", *self.places) if f"{{{one}}}" in self.texts["en"].what]
        return list(texts.problems(self.places, needed))

    def _require_texts(self, texts: FindingTexts, where: str) -> None:
        for place, message in self.problems(texts):
            raise ValueError(f"finding '{self.kind}'{where}: {place} {message}")
        missing = [name for name in LISTS if not getattr(texts, name) and (name != "if_danger" or self.can_be_danger)]
        if missing:
            raise ValueError(f"finding '{self.kind}'{where} has no texts of {', '.join(missing)}")
