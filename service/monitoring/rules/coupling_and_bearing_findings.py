"""Findings of couplings, bearings and pedestals: alert rules with the sources of their limits, names and texts."""

from service.monitoring.rules.finding_rule import AlertRule, FindingRule
from service.monitoring.rules.limit_rule import Level, Rule
from service.monitoring.rules.seal_texts import SEAL_TEXTS
from service.wording.finding_texts import FindingTexts
from service.wording.finding_words import (
    alignment_questions,
    bearing_words,
    element_questions,
    element_words,
    misalignment_words,
)
from service.wording.repeated_texts import (
    BALANCE_FIRST,
    BALANCE_FIRST_DE,
    NEW_BASELINE,
    NEW_BASELINE_DE,
    TAKE_RUN_DOWN,
    TAKE_RUN_DOWN_DE,
)

MISALIGNMENT = AlertRule(
    "misalignment",
    # Thermal seasons move stiffnesses by some 2 %. The thesis's smallest misalignment raises natural frequencies by up to 2 %,
    # hence stiffnesses by 4 % at least. On oil films a quarter of what is allowed is told, and more than that is a danger.
    limits=Rule(alert=Level(sigma=3, per_cent=3, tolerance_per_cent=25), danger=Level(per_cent=15, beyond_tolerance=0.95)),
    quantities=("sigma", "per_cent", "force", "tolerance_per_cent", "beyond_tolerance"),
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

STATED_FILMS = "Whether it is {id} itself or the load on it, where the document does not describe its film by geometry and oil"
STATED_FILMS_DE = (
    "Ob es {id} selbst ist oder die Last darauf, wo das Dokument den Ölfilm nicht durch Geometrie und Öl beschreibt"
)

COUPLING_AND_BEARING_FINDINGS: tuple[FindingRule, ...] = (
    FindingRule(
        "misalignment",
        MISALIGNMENT,
        {"de": "Ausrichtfehler"},
        {
            "en": FindingTexts(
                what="Coupling {id} {judgement}: {size}, {compared}, since {since}",
                check=(
                    "Metal and oil temperatures of the bearings beside coupling {id}, load and process temperature, since "
                    "{since}",
                    "2×, orbit and shaft centreline at the probes beside coupling {id}, over a run from before {since}",
                    "Pipes, hold-down bolts (soft foot) and foundation on both sides of coupling {id}",
                ),
                in_operation=(
                    TAKE_RUN_DOWN,
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
            "de": FindingTexts(
                what="Kupplung {id} {judgement}: {size}, {compared}, seit {since}",
                check=(
                    "Metall- und Öltemperaturen der Lager neben Kupplung {id}, Last und Prozesstemperatur, seit {since}",
                    "2×, Wellenbahn und Wellenlage an den Aufnehmern neben Kupplung {id}, gegenüber einem Lauf vor dem "
                    "{since}",
                    "Rohrleitungen, Fußschrauben (Kippfuß) und Fundament auf beiden Seiten von Kupplung {id}",
                ),
                in_operation=(
                    TAKE_RUN_DOWN_DE,
                    "Schwingung und Temperaturen der Lager neben Kupplung {id} in jeder Schicht beobachten",
                ),
                at_next_stop=(
                    "Ausrichtung an Kupplung {id} messen, bevor etwas gelöst wird, und mit diesen Zahlen vergleichen",
                    "Schrauben, Elemente oder Zähne und Fett von Kupplung {id} ansehen; neu ausrichten, wo sie falsch steht",
                    BALANCE_FIRST_DE,
                    NEW_BASELINE_DE,
                ),
                if_danger=(
                    "Mit dem Betrieb den frühesten Stillstand für Kupplung {id} vereinbaren; nicht wieder anfahren, bevor sie "
                    "angesehen ist",
                ),
                confirm=(
                    "Eine mit Laser oder Messuhren gemessene Ausrichtung, die in gleicher Richtung falsch ist",
                    "2×, das gewachsen ist, oder auseinandergelaufene Lagertemperaturen neben Kupplung {id} (gängige Praxis)",
                ),
                not_determined=("Welche der beiden Maschinen sich bewegt hat, oder ob die Kupplung selbst verschlissen ist",),
            ),
        },
        misalignment_words,
        places=("judgement",),
        force="misalignment_force",
        open_questions=alignment_questions,
    ),
    FindingRule(
        "bearing",
        BEARING,
        {"de": "Lager"},
        {
            "en": FindingTexts(
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
                if_danger=(
                    "Agree on the earliest stop for {element} with operations; watch its metal temperature until then",
                ),
                confirm=(
                    "A clearance or a contact pattern that is not as it was made",
                    "Metal temperature that moved with it",
                ),
                not_determined=(STATED_FILMS,),
            ),
            "de": FindingTexts(
                what="{judgement}: {size}, {compared}, seit {since}",
                check=(
                    "Ölvorlauftemperatur, Druck und Menge sowie Metalltemperatur von {element} seit {since}",
                    "Wellenlage in {element}, gegenüber einem Lauf vor dem {since}",
                ),
                in_operation=(
                    "Öltemperatur und Last über einen Auslauf konstant halten, damit sich nur {element} ändern kann",
                ),
                at_next_stop=(
                    "{element} öffnen: Lagerspiel, Tragbild, Weißmetall, Segmente und Stützpunkte, Sitz im Gehäuse",
                    NEW_BASELINE_DE,
                ),
                if_danger=(
                    "Mit dem Betrieb den frühesten Stillstand für {element} vereinbaren; bis dahin seine Metalltemperatur "
                    "beobachten",
                ),
                confirm=(
                    "Ein Lagerspiel oder ein Tragbild, das nicht ist wie gefertigt",
                    "Eine Metalltemperatur, die mitgelaufen ist",
                ),
                not_determined=(STATED_FILMS_DE,),
            ),
        },
        bearing_words,
        texts_of_elements={"seal": SEAL_TEXTS},
        places=("judgement",),
        open_questions=element_questions,
    ),
    FindingRule(
        "coupling",
        COUPLING,
        {"de": "Kupplung"},
        {
            "en": FindingTexts(
                what="Coupling {id} has changed by itself: {size}, {compared}, since {since}",
                check=("Torque and temperature at coupling {id} since {since}", "2× and phase across coupling {id}"),
                in_operation=(TAKE_RUN_DOWN,),
                at_next_stop=(
                    "Look at elements, bolts, teeth, hub fits and grease of coupling {id}",
                    "Measure the alignment at coupling {id}, which it may have suffered from",
                    NEW_BASELINE,
                ),
                if_danger=("Agree on the earliest stop for coupling {id} with operations: a coupling that breaks is thrown",),
                confirm=("Cracked, worn or loose parts of coupling {id}",),
                not_determined=("Which part of coupling {id} it is",),
            ),
            "de": FindingTexts(
                what="Kupplung {id} hat sich für sich geändert: {size}, {compared}, seit {since}",
                check=("Drehmoment und Temperatur an Kupplung {id} seit {since}", "2× und Phase über Kupplung {id} hinweg"),
                in_operation=(TAKE_RUN_DOWN_DE,),
                at_next_stop=(
                    "Elemente, Schrauben, Zähne, Nabensitze und Fett von Kupplung {id} ansehen",
                    "Ausrichtung an Kupplung {id} messen, unter der sie gelitten haben kann",
                    NEW_BASELINE_DE,
                ),
                if_danger=(
                    "Mit dem Betrieb den frühesten Stillstand für Kupplung {id} vereinbaren: eine brechende Kupplung wird "
                    "fortgeschleudert",
                ),
                confirm=("Gerissene, verschlissene oder lose Teile von Kupplung {id}",),
                not_determined=("Welches Teil von Kupplung {id} es ist",),
            ),
        },
        element_words,
        open_questions=element_questions,
    ),
    FindingRule(
        "pedestal",
        PEDESTAL,
        {"de": "Lagerbock"},
        {
            "en": FindingTexts(
                what="Pedestal {id} has changed by itself: {size}, {compared}, since {since}",
                check=(
                    "Hold-down bolts, grout and cracks of pedestal {id}",
                    "Pull of the pipes at pedestal {id}, warm and cold",
                ),
                in_operation=("Compare vibration of pedestal {id} across its joints, bolt by bolt (common practice)",),
                at_next_stop=(
                    "Tighten or mend what is loose at pedestal {id}, then check the alignment beside it",
                    NEW_BASELINE,
                ),
                if_danger=("Agree on the earliest stop for pedestal {id} with operations",),
                confirm=("A bolt that is loose, or a joint across which vibration jumps",),
                not_determined=("Which bolt, joint or crack it is",),
            ),
            "de": FindingTexts(
                what="Lagerbock {id} hat sich für sich geändert: {size}, {compared}, seit {since}",
                check=(
                    "Fußschrauben, Verguss und Risse von Lagerbock {id}",
                    "Zug der Rohrleitungen an Lagerbock {id}, warm und kalt",
                ),
                in_operation=(
                    "Schwingung von Lagerbock {id} über seine Fugen hinweg vergleichen, Schraube für Schraube (gängige "
                    "Praxis)",
                ),
                at_next_stop=(
                    "Festziehen oder instand setzen, was an Lagerbock {id} lose ist, dann die Ausrichtung daneben prüfen",
                    NEW_BASELINE_DE,
                ),
                if_danger=("Mit dem Betrieb den frühesten Stillstand für Lagerbock {id} vereinbaren",),
                confirm=("Eine lose Schraube, oder eine Fuge, über die hinweg die Schwingung springt",),
                not_determined=("Welche Schraube, welche Fuge oder welcher Riss es ist",),
            ),
        },
        element_words,
        open_questions=element_questions,
    ),
)
