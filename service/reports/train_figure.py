"""Picture of a train to scale from driver to driven, with what has an alert marked."""

from collections.abc import Iterable, Mapping

from estimator.machine.document import Machine
from estimator.machine.train_layout import disc_body, shaft_begins
from service.reports.plot_frame import INK, MARKED, MEASURED, label, segment, svg

WIDTH, MOST_HEIGHT = 630.0, 150.0
"""Largest size of the picture of the train itself [px]."""
SMALLEST_DISC = 0.012
"""Least width of a disc that is drawn, as a part of the train's length [-]."""
ROOM = 22.0
"""Room above and below for names [px]."""
SHAFT, DISC = "#c9ced6", "#8aa4c0"
TALL = 1.0
"""Largest radius that is drawn without being scaled down, as a part of a quarter of the picture's height [-]."""


def train_figure(machine: Machine, marked: Iterable[str]) -> str:
    """Return the picture. marked: elements such as `coupling.C1`."""
    begins, wrong = shaft_begins(machine), frozenset(marked)
    length = sum(shaft.length for shaft in machine.shafts)
    scale = WIDTH / length
    radius = max(_radii(machine, length))
    tall = min(scale, TALL * MOST_HEIGHT / 2.0 / radius)
    half = max(radius * tall, 14.0)
    parts = [*_shafts(machine, begins, scale, tall, wrong), *_discs(machine, begins, scale, tall, wrong)]
    parts += _supports(machine, begins, scale, half, wrong)
    for coupling in machine.couplings:
        at, colour = begins[coupling.driven] * scale, _colour(f"coupling.{coupling.id}", wrong)
        parts.append(segment(at, -half, at, half, colour, width=3.0))
        parts.append(label(at, -half - 4, coupling.id, colour=colour))
    parts += _probes(machine, begins, scale, half, wrong)
    height = 2.0 * (half + ROOM)
    return svg("".join(parts), WIDTH + 20.0, height, left=-10.0, top=-height / 2.0)


def _radii(machine: Machine, length: float) -> list[float]:
    sections = [section.outer_diameter / 2.0 for shaft in machine.shafts for section in shaft.sections]
    return sections + [disc_body(disc).radius or 0.05 * length for disc in machine.discs]


def _probes(machine: Machine, begins: Mapping[str, float], scale: float, half: float, wrong: frozenset[str]) -> Iterable[str]:
    """Yield a stroke for each probe, those with an alert last and named: others at their place must not hide them."""
    for probe in sorted(machine.probes, key=lambda one: f"probe.{one.id}" in wrong):
        at = (begins[probe.shaft] + probe.station) * scale
        is_wrong = f"probe.{probe.id}" in wrong
        yield segment(at, -half - 2, at, -half + 5, MARKED if is_wrong else MEASURED, width=1.2)
        if is_wrong:
            yield label(at, -half - 12, probe.id, colour=MARKED)


def _shafts(machine: Machine, begins: Mapping[str, float], scale: float, tall: float, wrong: frozenset[str]) -> Iterable[str]:
    for shaft in machine.shafts:
        at, colour = begins[shaft.id], MARKED if f"shaft.{shaft.id}" in wrong else SHAFT
        for section in shaft.sections:
            yield _block(at * scale, section.length * scale, max(section.outer_diameter / 2.0 * tall, 1.0), colour)
            at += section.length


def _discs(machine: Machine, begins: Mapping[str, float], scale: float, tall: float, wrong: frozenset[str]) -> Iterable[str]:
    length = sum(shaft.length for shaft in machine.shafts)
    for disc in machine.discs:
        body = disc_body(disc)
        half = (body.radius or 0.05 * length) * tall
        width = max(body.width or 0.0, SMALLEST_DISC * length) * scale
        centre = (begins[disc.shaft] + disc.station) * scale
        name = f"disc.{disc.id}"
        yield _block(centre - width / 2.0, width, half, MARKED if name in wrong else DISC)
        yield label(centre, -half - 4, disc.id, colour=_colour(name, wrong))


def _supports(
    machine: Machine, begins: Mapping[str, float], scale: float, half: float, wrong: frozenset[str]
) -> Iterable[str]:
    for kind, parts in (("bearing", machine.bearings), ("seal", machine.seals)):
        for one in parts:
            at, colour = (begins[one.shaft] + one.station) * scale, _colour(f"{kind}.{one.id}", wrong)
            triangle = f"{at:.1f},2 {at - 6:.1f},{half:.1f} {at + 6:.1f},{half:.1f}"
            filled = colour if kind == "bearing" else "none"
            yield f'<polygon points="{triangle}" fill="{filled}" stroke="{colour}" stroke-width="0.8"/>'
            yield label(at, half + 12, one.id, colour=colour)
            pedestal = machine.pedestal_of(one.id) if kind == "bearing" else None
            if pedestal is not None:
                base = _colour(f"pedestal.{pedestal.id}", wrong)
                yield segment(at - 8, half + 2, at + 8, half + 2, base, width=2.0)
                yield label(at, half + 19, pedestal.id, colour=base) if base == MARKED else ""


def _block(left: float, width: float, half: float, colour: str) -> str:
    place = f'x="{left:.1f}" y="{-half:.1f}" width="{width:.1f}" height="{2.0 * half:.1f}"'
    return f'<rect {place} fill="{colour}" stroke="{INK}" stroke-width="0.4"/>'


def _colour(element: str, wrong: frozenset[str]) -> str:
    return MARKED if element in wrong else INK
