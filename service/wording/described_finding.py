"""A finding as texts describe it: its kind, element and numbers, read from its stored evidence."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any, cast

from estimator.diagnosis.finding_kind import SizePart
from estimator.machine.parameter_description import describe
from service.wording.language import ENGLISH, Language

MILLIRADIANS = 1e-3
"""Milliradians in a microradian: angles are told in these, as people who align write them."""


@dataclass(frozen=True)
class DescribedFinding:
    """A finding, its numbers, and the language in which it is described.

    evidence: as `Statement.evidence` returns it, or as an older release has stored it.
    """

    kind: str
    element: str
    evidence: Mapping[str, Any]
    language: Language = ENGLISH

    @property
    def id(self) -> str:
        """Return the id of its element, such as C1."""
        return describe(self.element).element_id or self.element

    @property
    def element_kind(self) -> str:
        """Return the kind of its element, such as coupling."""
        return describe(self.element).element_kind

    @property
    def quantities(self) -> Mapping[str, float]:
        """Return the numbers of its size, by name with the unit at its end."""
        return cast("Mapping[str, float]", self.evidence.get("quantities") or {})

    @property
    def form(self) -> str | None:
        """Return its form, such as `parallel`; None when unknown."""
        return cast("str | None", self.evidence.get("form"))

    @property
    def of_films(self) -> bool:
        """Return whether its size is an alignment on oil films."""
        return "allowed_at_rpm" in self.quantities

    def stored_parts(self) -> Iterator[SizePart]:
        """Yield the figures of its size in the units that are stored; none of what an older release has stored."""
        for one in self.evidence.get("parts") or ():
            yield SizePart(**(one | {"members": tuple(one["members"])}))

    def parts(self) -> Iterator[SizePart]:
        """Yield the same figures as they are told: lengths in the reader's unit, angles in mrad."""
        for part in self.stored_parts():
            if part.unit == "urad":
                yield _scaled(part, MILLIRADIANS, unit="mrad")
            elif part.unit == "um" and self.language.length_unit != "µm":
                yield _scaled(part, self.language.in_length_unit(1.0), unit=self.language.length_unit)
            else:
                yield part

    def elements_in_per_cent(self) -> set[str]:
        """Return the elements whose figures are in per cent."""
        return {describe(one.name).element for one in self.parts() if one.unit == "%"}

    def runs_of(self, part: SizePart) -> int | None:
        """Return of how many of the newest runs a figure is the mean: loads and alignments are the newest one's."""
        if part.before is not None or self.of_films:
            return 1
        return cast("int | None", self.evidence.get("runs"))

    def is_tellable(self) -> bool:
        """Return whether the evidence has the numbers that texts name; those of the first releases have not."""
        return "since" in self.evidence and "quantities" in self.evidence


def _scaled(part: SizePart, factor: float, *, unit: str) -> SizePart:
    told = {name: getattr(part, name) for name in ("value", "lower", "upper", "allowed", "before")}
    scaled = {name: None if one is None else factor * one for name, one in told.items()}
    return replace(part, unit=unit, **scaled)  # type: ignore[arg-type]
