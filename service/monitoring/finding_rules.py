"""The findings that are reported to people, each declared once: its alert rule, its limits and its texts.

`FINDING_RULES` has one declaration for each of the estimator's `FINDING_KINDS`; otherwise the import of this module fails.
"""

from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING

from estimator.diagnosis.finding_kinds import FINDING_KINDS, finding_kind
from service.monitoring.finding_rule import AlertRule, FindingRule
from service.monitoring.limit_rule import Level, Rule
from service.wording.finding_texts import FindingTexts
from service.wording.finding_words import (
    alignment_questions,
    bearing_words,
    coupling_run_out_words,
    element_questions,
    element_words,
    misalignment_words,
    oil_words,
    process_force_words,
    rate_words,
    run_out_words,
    sensor_words,
    settlement_size,
    size_words,
    unbalance_words,
    wear_size,
)

if TYPE_CHECKING:
    from estimator.diagnosis.finding_kind import ElementKind

# --- alert rules, with the sources of their limits ---------------------------------------------------------------------------

MISALIGNMENT = AlertRule(
    "misalignment",
    # Thermal seasons move stiffnesses by some 2 %. The thesis's smallest misalignment raises natural frequencies by up to 2 %,
    # hence stiffnesses by 4 % at least. On oil films a quarter of what is allowed is told, and more than that is a danger.
    limits=Rule(alert=Level(sigma=3, per_cent=3, tolerance_per_cent=25), danger=Level(per_cent=15, beyond_tolerance=0.95)),
    quantities=("sigma", "per_cent", "force", "tolerance_per_cent", "beyond_tolerance"),
)
SETTLEMENT = AlertRule(
    "settlement",
    limits=Rule(alert=Level(sigma=4, tolerance_per_cent=50), danger=Level(tolerance_per_cent=200)),
    quantities=("sigma", "tolerance_per_cent"),
)
WEAR = AlertRule(
    "wear",
    # A clearance is known to some 3 % against its baseline; makers replace bearings at about twice the new clearance.
    limits=Rule(alert=Level(sigma=4, per_cent=8), danger=Level(per_cent=50)),
    quantities=("sigma", "per_cent"),
)
OIL = AlertRule(
    "oil",
    # Grades of ISO 3448 are 50 % apart; 10 K are some 50 % as well.
    limits=Rule(alert=Level(sigma=4, per_cent=60)),
    quantities=("sigma", "per_cent"),
)
PROCESS_FORCE = AlertRule(
    "process_force",
    # Gears and partial admission follow the power, which changes from run to run.
    limits=Rule(alert=Level(sigma=4, per_cent=50)),
    quantities=("sigma", "per_cent"),
)
BEARING = AlertRule(
    "bearing",
    # An oil film's stiffness and damping follow oil temperature and load more than a coupling's do. Films that are described
    # by geometry and oil may deviate from their model by what the document says.
    limits=Rule(alert=Level(sigma=4, per_cent=5, tolerance_per_cent=100), danger=Level(per_cent=25, tolerance_per_cent=300)),
    quantities=("sigma", "per_cent", "tolerance_per_cent"),
    deviations=("bearing", "seal"),
)
PEDESTAL = AlertRule(
    "pedestal",
    # Neither oil nor load moves it: what does is a bolt, a crack, grout or a pipe's pull.
    limits=Rule(alert=Level(sigma=4, per_cent=5), danger=Level(per_cent=25)),
    quantities=("sigma", "per_cent"),
    deviations=("pedestal",),
)
COUPLING = AlertRule(
    "coupling",
    limits=Rule(alert=Level(sigma=4, per_cent=5), danger=Level(per_cent=25)),
    quantities=("sigma", "per_cent"),
    deviations=("coupling",),
)
UNBALANCE = AlertRule(
    "unbalance",
    # ISO 20816-1 calls a change of a vibration vector by a quarter of the zone B limit significant.
    limits=Rule(alert=Level(sigma=4, per_cent=25), danger=Level(per_cent=100)),
    quantities=("sigma", "per_cent"),
    deviations=("disc",),
)
ROTATING_COUPLING = AlertRule(
    "rotating_coupling",
    # 100 % is a reading of 0.05 mm at rim and face, usually allowed. Rigid couplings pull hard with a tenth of that.
    limits=Rule(alert=Level(sigma=4, tolerance_per_cent=3), danger=Level(tolerance_per_cent=100)),
    quantities=("sigma", "tolerance_per_cent"),
)
RUN_OUT = AlertRule(
    "run_out",
    limits=Rule(alert=Level(sigma=4, per_cent=25)),
    quantities=("sigma", "per_cent"),
    deviations=("shaft",),
)
SENSOR = AlertRule(
    "sensor",
    # API 670 allows a probe's scale factor 5 %. A wrong sensor is no danger to the machine.
    limits=Rule(alert=Level(sigma=4, per_cent=5)),
    quantities=("sigma", "per_cent"),
    deviations=("probe",),
)
RATE_OF_CHANGE = AlertRule(
    "rate_of_change",
    # Seasons drift by 0.25 % a week at their steepest.
    limits=Rule(alert=Level(rate_per_cent_per_week=0.5), danger=Level(rate_per_cent_per_week=2)),
    quantities=("rate_per_cent_per_week",),
    elements=("bearing", "seal", "pedestal", "coupling", "disc"),
)
"""Rule for parameters that drift too fast, whatever the diagnosis: see `service.monitoring.rate_of_change`."""

BALANCE_FIRST = (
    "Do not balance coupling {id}'s machines before: weights would hide the cause and not mend it (common practice)"
)
NEW_BASELINE = "After the work, enter a maintenance on the machine's timeline: a new baseline begins"
STATED_FILMS = "Whether it is {id} itself or the load on it, where the document does not describe its film by geometry and oil"

FINDING_RULES: tuple[FindingRule, ...] = (
    FindingRule(
        "misalignment",
        MISALIGNMENT,
        FindingTexts(
            what="Coupling {id} {judgement}: {size}, {compared}, since {since}",
            check=(
                "Metal and oil temperatures of the bearings beside coupling {id}, load and process temperature, since {since}",
                "2×, orbit and shaft centreline at the probes beside coupling {id}, over a run from before {since}",
                "Pipes, hold-down bolts (soft foot) and foundation on both sides of coupling {id}",
            ),
            in_operation=(
                "Take a run-down at the next chance: it shows whether the change grows",
                "Watch vibration and temperatures of the bearings beside coupling {id} in every shift",
            ),
            at_next_stop=(
                "Measure the alignment at coupling {id} before anything is loosened, and compare it with these figures",
                "Look at bolts, elements or teeth, and grease of coupling {id}; align anew where it is off",
                BALANCE_FIRST,
                NEW_BASELINE,
            ),
            if_danger=(
                "Agree on the earliest stop for coupling {id} with operations; do not start again before it is looked at",
            ),
            confirm=(
                "An alignment, measured by laser or dial gauges, that is off the same way",
                "2× that has grown, or bearing temperatures that have moved apart, beside coupling {id} (common practice)",
            ),
            not_determined=("Which of the two machines has moved, or whether the coupling itself is worn",),
        ),
        misalignment_words,
        places=("judgement",),
        force="misalignment_force",
        open_questions=alignment_questions,
    ),
    FindingRule(
        "bearing",
        BEARING,
        FindingTexts(
            what="{judgement}: {size}, {compared}, since {since}",
            check=(
                "Oil supply temperature, pressure and flow, and metal temperature, of {element} since {since}",
                "Shaft centreline in {element}, over a run from before {since}",
            ),
            in_operation=("Hold oil temperature and load steady over a run-down, so that only {element} can differ",),
            at_next_stop=(
                "Open {element}: clearance, contact pattern, white metal, pads and pivots, fit in its housing",
                NEW_BASELINE,
            ),
            if_danger=("Agree on the earliest stop for {element} with operations; watch its metal temperature until then",),
            confirm=("A clearance or a contact pattern that is not as it was made", "Metal temperature that moved with it"),
            not_determined=(STATED_FILMS,),
        ),
        bearing_words,
        places=("judgement",),
        open_questions=element_questions,
    ),
    FindingRule(
        "coupling",
        COUPLING,
        FindingTexts(
            what="Coupling {id} has changed by itself: {size}, {compared}, since {since}",
            check=("Torque and temperature at coupling {id} since {since}", "2× and phase across coupling {id}"),
            in_operation=("Take a run-down at the next chance: it shows whether the change grows",),
            at_next_stop=(
                "Look at elements, bolts, teeth, hub fits and grease of coupling {id}",
                "Measure the alignment at coupling {id}, which it may have suffered from",
                NEW_BASELINE,
            ),
            if_danger=("Agree on the earliest stop for coupling {id} with operations: a coupling that breaks is thrown",),
            confirm=("Cracked, worn or loose parts of coupling {id}",),
            not_determined=("Which part of coupling {id} it is",),
        ),
        element_words,
        open_questions=element_questions,
    ),
    FindingRule(
        "pedestal",
        PEDESTAL,
        FindingTexts(
            what="Pedestal {id} has changed by itself: {size}, {compared}, since {since}",
            check=("Hold-down bolts, grout and cracks of pedestal {id}", "Pull of the pipes at pedestal {id}, warm and cold"),
            in_operation=("Compare vibration of pedestal {id} across its joints, bolt by bolt (common practice)",),
            at_next_stop=("Tighten or mend what is loose at pedestal {id}, then check the alignment beside it", NEW_BASELINE),
            if_danger=("Agree on the earliest stop for pedestal {id} with operations",),
            confirm=("A bolt that is loose, or a joint across which vibration jumps",),
            not_determined=("Which bolt, joint or crack it is",),
        ),
        element_words,
        open_questions=element_questions,
    ),
    FindingRule(
        "settlement",
        SETTLEMENT,
        FindingTexts(
            what="Bearing {id} stands {size}, {compared}, since {since}",
            check=("Foundation and shims under bearing {id}", "Metal temperatures of bearing {id} and its neighbours"),
            in_operation=("Compare load and temperature of bearing {id} with those of its neighbours",),
            at_next_stop=("Measure the elevation of bearing {id} and set its shims", NEW_BASELINE),
            if_danger=("Agree on the earliest stop for bearing {id} with operations",),
            confirm=("A levelling of the bearings' housings that is off the same way",),
            not_determined=("Elevations that are a change of one coupling's alignment as well",),
        ),
        settlement_size,
    ),
    FindingRule(
        "wear",
        WEAR,
        FindingTexts(
            what="Bearing {id} is worn: its radial clearance is {size}, {compared}, since {since}",
            check=("Particles and metal in the oil of bearing {id}", "Metal temperature and shaft centreline of bearing {id}"),
            in_operation=("Take oil samples, and run-downs at the same oil temperature: they show how fast it wears",),
            at_next_stop=("Measure the clearance of bearing {id}; have shells of its size ready before", NEW_BASELINE),
            if_danger=("Agree on the earliest stop for bearing {id} with operations, with new shells at hand",),
            confirm=("A clearance, measured by lead wire or lift check, that has grown as much",),
            not_determined=("Where in the bore it is worn, and why",),
        ),
        wear_size,
    ),
    FindingRule(
        "oil",
        OIL,
        FindingTexts(
            what="The oil in the bearings is of another viscosity, {size}: look at its grade and temperature, "
            "{compared}, since {since}",
            check=("Grade on the last delivery note, oil temperature at the supply, and water or fuel in the oil",),
            in_operation=("Set the cooler so that the oil has its usual temperature; take a sample for its viscosity",),
            at_next_stop=("Change the oil where its sample says so", NEW_BASELINE),
            confirm=("A sample whose viscosity at 40 °C is off by as much",),
            not_determined=("Whether grade, temperature or water is the cause",),
        ),
        oil_words,
    ),
    FindingRule(
        "process_force",
        PROCESS_FORCE,
        FindingTexts(
            what="The static force {id} has changed: {size}, {compared}, since {since}",
            check=("Power, valves and pressures since {since}: what static force {id} comes from",),
            in_operation=("Take a run-down at the usual power: it shows whether static force {id} follows it",),
            at_next_stop=("Look at valves, nozzles, teeth or pipes that make static force {id}", NEW_BASELINE),
            confirm=("A power or pressure that has changed with it",),
            not_determined=("What changes static force {id}", "A force that no static load of the document stands for"),
        ),
        process_force_words,
    ),
    FindingRule(
        "light_load",
        AlertRule("light_load"),
        FindingTexts(
            what="Bearing {id} carries hardly any load: less than a tenth of what it carried, so that it may whirl, "
            "{compared}, since {since}",
            check=("Vibration below running speed at bearing {id}, in a spectrum of another instrument",),
            in_operation=("Keep oil warm within its limits: a thinner film whirls later (common practice)",),
            at_next_stop=("Measure the alignment beside bearing {id} and its elevation",),
            confirm=("Low metal temperature at bearing {id}", "Vibration at somewhat less than half the running speed"),
            not_determined=("By how much bearing {id} has been unloaded",),
        ),
        size_words,
    ),
    FindingRule(
        "heavy_load",
        AlertRule("heavy_load"),
        FindingTexts(
            what="Bearing {id} carries more than 5 MPa of its area, the most that white metal takes (ISO 7902-3), "
            "{compared}, since {since}",
            check=("Metal temperature of bearing {id} now, and its alarm limit",),
            in_operation=("Reduce load where operations can; watch the metal temperature of bearing {id} in every shift",),
            at_next_stop=("Measure the alignment beside bearing {id} and its elevation; look at its white metal",),
            confirm=("High metal temperature at bearing {id}",),
            not_determined=("By how much bearing {id} is beyond that",),
        ),
        size_words,
    ),
    FindingRule(
        "low_stability",
        AlertRule("low_stability"),
        FindingTexts(
            what="The machine is close to whirling in its oil films: at running speed its least damped mode has a logarithmic "
            "decrement below 0.1 (API 617), and less than half of what it had with such oil, {compared}, since {since}",
            check=(
                "Vibration below running speed, in a spectrum of another instrument",
                "What has changed beside it: an alignment, a clearance, the oil and its temperature",
            ),
            in_operation=("Keep oil temperature within its limits, and do not raise the speed while this stands",),
            at_next_stop=("Measure alignment, clearances and elevations of the bearings that carry least", NEW_BASELINE),
            confirm=("Vibration at somewhat less than half the running speed",),
            not_determined=("Which bearing it begins in",),
        ),
        size_words,
    ),
    FindingRule(
        "unbalance",
        UNBALANCE,
        FindingTexts(
            what="The unbalance of disc {id} has changed by {size}, {compared}, since {since}",
            check=(
                "Whether 1× changed at once or slowly at the probes of disc {id}: a part lost, or deposits and erosion",
                "What changed at {since}: a start, a trip, a wash, a load, a temperature",
            ),
            in_operation=("Where it came at once, treat it as a part lost until shown otherwise (common practice)",),
            at_next_stop=(
                "Look for lost parts, deposits and rubs at disc {id}",
                "Balance in place where nothing is found",
                NEW_BASELINE,
            ),
            if_danger=("Agree with operations on a stop; where it came at once, before the next start",),
            confirm=(
                "A missing part or deposit at the angle of the change",
                "1× that falls when disc {id} is cleaned or balanced",
            ),
            not_determined=("What causes it: a loss, deposits or a bend of the disc",),
        ),
        unbalance_words,
    ),
    FindingRule(
        "rotating_coupling",
        ROTATING_COUPLING,
        FindingTexts(
            what="The run-out of coupling {id} has changed, {size}: it turns with the shaft, whatever the speed, "
            "{compared}, since {since}",
            check=("What was done at coupling {id} at {since}: hubs fitted anew, bolts, spacer or marks that do not match",),
            in_operation=("Take a run-down at the next chance: it shows whether the change grows",),
            at_next_stop=(
                "Measure rim and face run-out of both hubs of coupling {id} with dial gauges while the shaft turns",
                "Look for a hub that sits askew, wrong bolt lengths and dirt in the spigot of coupling {id}",
                BALANCE_FIRST,
                NEW_BASELINE,
            ),
            if_danger=("Agree on the earliest stop for coupling {id} with operations",),
            confirm=("A rim or face run-out of coupling {id} that is off at the same angle",),
            not_determined=("Which of the two hubs of coupling {id} it is",),
        ),
        coupling_run_out_words,
    ),
    FindingRule(
        "bow",
        RUN_OUT,
        FindingTexts(
            what="The bow, or the run-out at all probes, of shaft {id} has changed by {size}, {compared}, since {since}",
            check=("Slow roll of shaft {id}, cold and hot, and how it stood before the start",),
            in_operation=(
                "Let shaft {id} turn slowly until its slow roll is steady, before the next start (common practice)",
            ),
            at_next_stop=("Measure the run-out of shaft {id} with a dial gauge along its length",),
            confirm=("A run-out by dial gauge that is as large", "A slow roll that falls while shaft {id} turns slowly"),
            not_determined=("Whether shaft {id} is bent for good or by heat only",),
        ),
        run_out_words,
    ),
    FindingRule(
        "run_out",
        RUN_OUT,
        FindingTexts(
            what="The run-out at probe {id} has changed by {size}, {compared}, since {since}",
            check=("The shaft's surface under probe {id}: scratches, rust, magnetism",),
            in_operation=("Record slow-roll vectors anew at the next run-down and subtract them",),
            at_next_stop=("Clean or burnish the track under probe {id}; look at its holder",),
            confirm=("A slow roll at probe {id} that has changed while its neighbours have not",),
            not_determined=("Whether surface, magnetism or holder is the cause",),
        ),
        run_out_words,
    ),
    FindingRule(
        "sensor",
        SENSOR,
        FindingTexts(
            what="Probe {id} {size}, {compared}, since {since}",
            check=(
                "Gap voltage, connectors, cable and driver of probe {id}",
                "Settings of the channel {id} in its instrument",
            ),
            in_operation=("Do not act on what channel {id} says by itself; take it out of alarms by the site's own rules",),
            at_next_stop=("Calibrate probe {id} with its own cable and driver, or replace them",),
            confirm=("A calibration curve of probe {id} that is off by as much",),
            not_determined=("Which part of the chain it is: probe, cable, driver or input",),
        ),
        sensor_words,
    ),
    FindingRule(
        "misfit",
        AlertRule("misfit"),
        FindingTexts(
            what="No fit explains the machine's newest runs: its model does not hold any more, or its data are wrong, "
            "{compared}, since {since}",
            check=(
                "Residuals of the newest identification: one channel, one speed range, or everywhere",
                "What was changed at the machine, its instruments or its document at {since}",
            ),
            in_operation=("Compare 1× with a run from before {since} by eye, and judge the machine by its vibration limits",),
            at_next_stop=("Look at instruments first, then at supports and couplings",),
            confirm=("A fit that is accepted again once the channel or the document is mended",),
            not_determined=("Whether machine, instruments or document is the cause",),
        ),
        size_words,
    ),
    FindingRule(
        "outliers",
        AlertRule("outliers"),
        FindingTexts(
            what="Many single phasors of the newest runs do not fit and are left out: look at cables, connections and "
            "interference, {compared}, since {since}",
            check=("Cables, shields, connectors and the keyphasor", "Welding, drives or radio near the cables at that time"),
            in_operation=("Watch the channel's quality on the run's page",),
            at_next_stop=("Mend cables and earthing; look at gap and surface of the keyphasor's mark",),
            confirm=("Phasors that fit again once a cable or connection is mended",),
            not_determined=("Which cable or source of interference it is",),
        ),
        size_words,
    ),
)

RATE_RULE = FindingRule(
    "rate_of_change",
    RATE_OF_CHANGE,
    FindingTexts(
        what="{parameter} drifts by {size} over the last {runs} runs",
        check=("Whether load, temperature or oil drift with it: then an operating condition in the document takes that out",),
        in_operation=("Take run-downs more often while it drifts",),
        at_next_stop=("Look at {element}",),
        if_danger=("Agree with operations on a stop for {element} before its limit is reached",),
        confirm=("A drift that goes on in the next runs, under the same load and temperature",),
        not_determined=("What causes the drift: the diagnosis says so once it is sure",),
    ),
    rate_words,
    places=("parameter",),
)
"""Declaration of how drifts are reported."""


def require_complete(declared: Sequence[FindingRule], kinds: Iterable[str]) -> Mapping[str, FindingRule]:
    """Return the declarations by kind. Raises ValueError unless there is exactly one for each kind of finding."""
    found = {one.kind: one for one in declared}
    if len(found) < len(declared):
        raise ValueError(f"a finding is declared twice: {', '.join(one.kind for one in declared)}")
    missing, unknown = sorted(set(kinds) - set(found)), sorted(set(found) - set(kinds))
    if missing:
        raise ValueError(f"findings without texts and alert rule in FINDING_RULES: {', '.join(missing)}")
    if unknown:
        raise ValueError(f"FINDING_RULES has what is no kind of finding of the estimator: {', '.join(unknown)}")
    return found


_BY_KIND = require_complete(FINDING_RULES, [one.kind for one in FINDING_KINDS])


def finding_rule(kind: str) -> FindingRule:
    """Return the declaration of a kind of finding. Raises KeyError when there is none."""
    return _BY_KIND[kind]


def told_rule(kind: str) -> FindingRule:
    """Return the declaration of a kind of finding, or of `rate_of_change`. Raises KeyError when there is none."""
    return RATE_RULE if kind == RATE_RULE.kind else _BY_KIND[kind]


def is_finding(kind: str) -> bool:
    """Return whether a kind of finding exists."""
    return kind in _BY_KIND


def _rules_by_name() -> Mapping[str, AlertRule]:
    """Return the alert rules of all findings. Raises ValueError for two different ones of one name."""
    found: dict[str, AlertRule] = {}
    for one in FINDING_RULES:
        if found.setdefault(one.rule.name, one.rule) is not one.rule:
            raise ValueError(f"two alert rules are called '{one.rule.name}': finding '{one.kind}' needs one of its own name")
    return found


DIAGNOSIS_RULES = _rules_by_name()
"""Alert rules of the findings of a diagnosis, by name."""
LIMITED_RULES: Mapping[str, AlertRule] = {
    name: rule for name, rule in {**DIAGNOSIS_RULES, RATE_OF_CHANGE.name: RATE_OF_CHANGE}.items() if rule.limits is not None
}
"""Alert rules with limits, by name, in the order of display."""


def concerned_elements(rule: AlertRule) -> tuple["ElementKind", ...]:
    """Return the kinds of elements that a rule concerns."""
    of_findings = (kind for one in FINDING_RULES if one.rule is rule for kind in finding_kind(one.kind).elements)
    return tuple(dict.fromkeys((*of_findings, *rule.elements)))
