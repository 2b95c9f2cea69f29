"""The findings that are reported to people, each declared once: alert rule and limits, names and texts in each language.

`ROTOR_FINDINGS` holds those of rotors, probes and data. `FINDING_RULES` has one declaration for each of the estimator's
`FINDING_KINDS`, which `finding_catalogue.py` requires and looks up.
"""

from service.monitoring.rules.finding_rule import AlertRule, FindingRule
from service.monitoring.rules.limit_rule import Level, Rule
from service.monitoring.rules.rotor_findings import ROTOR_FINDINGS
from service.wording.finding_texts import FindingTexts
from service.wording.finding_words import (
    alignment_questions,
    bearing_words,
    element_questions,
    element_words,
    misalignment_words,
    oil_words,
    process_force_words,
    rate_words,
    settlement_size,
    size_words,
    wear_size,
)
from service.wording.repeated_texts import (
    BALANCE_FIRST,
    BALANCE_FIRST_DE,
    NEW_BASELINE,
    NEW_BASELINE_DE,
    TAKE_RUN_DOWN,
    TAKE_RUN_DOWN_DE,
)

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
RATE_OF_CHANGE = AlertRule(
    "rate_of_change",
    # Seasons drift by 0.25 % a week at their steepest.
    limits=Rule(alert=Level(rate_per_cent_per_week=0.5), danger=Level(rate_per_cent_per_week=2)),
    quantities=("rate_per_cent_per_week",),
    elements=("bearing", "seal", "pedestal", "coupling", "disc"),
)
"""Rule for parameters that drift too fast, whatever the diagnosis: see `service.monitoring.assessment.rate_of_change`."""

STATED_FILMS = "Whether it is {id} itself or the load on it, where the document does not describe its film by geometry and oil"
STATED_FILMS_DE = (
    "Ob es {id} selbst ist oder die Last darauf, wo das Dokument den Ölfilm nicht durch Geometrie und Öl beschreibt"
)

FINDING_RULES: tuple[FindingRule, ...] = (
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
    FindingRule(
        "settlement",
        SETTLEMENT,
        {"de": "Setzung"},
        {
            "en": FindingTexts(
                what="Bearing {id} stands {size}, {compared}, since {since}",
                check=("Foundation and shims under bearing {id}", "Metal temperatures of bearing {id} and its neighbours"),
                in_operation=("Compare load and temperature of bearing {id} with those of its neighbours",),
                at_next_stop=("Measure the elevation of bearing {id} and set its shims", NEW_BASELINE),
                if_danger=("Agree on the earliest stop for bearing {id} with operations",),
                confirm=("A levelling of the bearings' housings that is off the same way",),
                not_determined=("Elevations that are a change of one coupling's alignment as well",),
            ),
            "de": FindingTexts(
                what="Lager {id} steht {size}, {compared}, seit {since}",
                check=("Fundament und Unterlagen unter Lager {id}", "Metalltemperaturen von Lager {id} und seinen Nachbarn"),
                in_operation=("Last und Temperatur von Lager {id} mit denen seiner Nachbarn vergleichen",),
                at_next_stop=("Höhe von Lager {id} messen und Unterlagen anpassen", NEW_BASELINE_DE),
                if_danger=("Mit dem Betrieb den frühesten Stillstand für Lager {id} vereinbaren",),
                confirm=("Ein Nivellement der Lagergehäuse, das in gleicher Richtung abweicht",),
                not_determined=("Höhen, die zugleich eine Änderung der Ausrichtung einer Kupplung sind",),
            ),
        },
        settlement_size,
    ),
    FindingRule(
        "wear",
        WEAR,
        {"de": "Verschleiß"},
        {
            "en": FindingTexts(
                what="Bearing {id} is worn: its radial clearance is {size}, {compared}, since {since}",
                check=(
                    "Particles and metal in the oil of bearing {id}",
                    "Metal temperature and shaft centreline of bearing {id}",
                ),
                in_operation=("Take oil samples, and run-downs at the same oil temperature: they show how fast it wears",),
                at_next_stop=("Measure the clearance of bearing {id}; have shells of its size ready before", NEW_BASELINE),
                if_danger=("Agree on the earliest stop for bearing {id} with operations, with new shells at hand",),
                confirm=("A clearance, measured by lead wire or lift check, that has grown as much",),
                not_determined=("Where in the bore it is worn, and why",),
            ),
            "de": FindingTexts(
                what="Lager {id} ist verschlissen: sein radiales Lagerspiel ist {size}, {compared}, seit {since}",
                check=("Partikel und Metall im Öl von Lager {id}", "Metalltemperatur und Wellenlage von Lager {id}"),
                in_operation=(
                    "Ölproben nehmen, und Ausläufe bei gleicher Öltemperatur: sie zeigen, wie schnell es verschleißt",
                ),
                at_next_stop=(
                    "Lagerspiel von Lager {id} messen; Lagerschalen seiner Größe vorher bereitlegen",
                    NEW_BASELINE_DE,
                ),
                if_danger=("Mit dem Betrieb den frühesten Stillstand für Lager {id} vereinbaren, neue Schalen bereithalten",),
                confirm=("Ein mit Bleidraht oder Anhebemessung bestimmtes Lagerspiel, das ebenso gewachsen ist",),
                not_determined=("Wo in der Bohrung es verschlissen ist, und warum",),
            ),
        },
        wear_size,
    ),
    FindingRule(
        "oil",
        OIL,
        {"de": "Öl"},
        {
            "en": FindingTexts(
                what="The oil in the bearings is of another viscosity, {size}: look at its grade and temperature, "
                "{compared}, since {since}",
                check=("Grade on the last delivery note, oil temperature at the supply, and water or fuel in the oil",),
                in_operation=("Set the cooler so that the oil has its usual temperature; take a sample for its viscosity",),
                at_next_stop=("Change the oil where its sample says so", NEW_BASELINE),
                confirm=("A sample whose viscosity at 40 °C is off by as much",),
                not_determined=("Whether grade, temperature or water is the cause",),
            ),
            "de": FindingTexts(
                what="Das Öl in den Lagern hat eine andere Viskosität, {size}: Sorte und Temperatur ansehen, {compared}, seit "
                "{since}",
                check=("Sorte auf dem letzten Lieferschein, Öltemperatur im Vorlauf, Wasser oder Kraftstoff im Öl",),
                in_operation=(
                    "Kühler so einstellen, dass das Öl seine übliche Temperatur hat; eine Probe auf Viskosität nehmen",
                ),
                at_next_stop=("Öl wechseln, wo die Probe es verlangt", NEW_BASELINE_DE),
                confirm=("Eine Probe, deren Viskosität bei 40 °C um ebenso viel abweicht",),
                not_determined=("Ob Sorte, Temperatur oder Wasser die Ursache ist",),
            ),
        },
        oil_words,
    ),
    FindingRule(
        "process_force",
        PROCESS_FORCE,
        {"de": "statische Kraft"},
        {
            "en": FindingTexts(
                what="The static force {id} has changed: {size}, {compared}, since {since}",
                check=("Power, valves and pressures since {since}: what static force {id} comes from",),
                in_operation=("Take a run-down at the usual power: it shows whether static force {id} follows it",),
                at_next_stop=("Look at valves, nozzles, teeth or pipes that make static force {id}", NEW_BASELINE),
                confirm=("A power or pressure that has changed with it",),
                not_determined=("What changes static force {id}", "A force that no static load of the document stands for"),
            ),
            "de": FindingTexts(
                what="Die statische Kraft {id} hat sich geändert: {size}, {compared}, seit {since}",
                check=("Leistung, Ventile und Drücke seit {since}: woher die statische Kraft {id} kommt",),
                in_operation=(
                    "Einen Auslauf bei üblicher Leistung aufnehmen: er zeigt, ob die statische Kraft {id} ihr folgt",
                ),
                at_next_stop=(
                    "Ventile, Düsen, Zähne oder Rohre ansehen, von denen die statische Kraft {id} kommt",
                    NEW_BASELINE_DE,
                ),
                confirm=("Eine Leistung oder ein Druck, die sich mit ihr geändert haben",),
                not_determined=(
                    "Was die statische Kraft {id} ändert",
                    "Eine Kraft, für die im Dokument keine statische Kraft steht",
                ),
            ),
        },
        process_force_words,
    ),
    FindingRule(
        "light_load",
        AlertRule("light_load"),
        {"de": "zu geringe Lagerlast"},
        {
            "en": FindingTexts(
                what="Bearing {id} carries hardly any load: less than a tenth of what it carried, so that it may whirl, "
                "{compared}, since {since}",
                check=("Vibration below running speed at bearing {id}, in a spectrum of another instrument",),
                in_operation=("Keep oil warm within its limits: a thinner film whirls later (common practice)",),
                at_next_stop=("Measure the alignment beside bearing {id} and its elevation",),
                confirm=("Low metal temperature at bearing {id}", "Vibration at somewhat less than half the running speed"),
                not_determined=("By how much bearing {id} has been unloaded",),
            ),
            "de": FindingTexts(
                what="Lager {id} trägt kaum noch Last: weniger als ein Zehntel der früheren, sodass Ölwirbel (Oil Whirl) "
                "auftreten können, {compared}, seit {since}",
                check=("Schwingung unter der Drehfrequenz an Lager {id}, im Spektrum eines anderen Geräts",),
                in_operation=(
                    "Öl innerhalb seiner Grenzen warm halten: ein dünnerer Film wird später instabil (gängige Praxis)",
                ),
                at_next_stop=("Ausrichtung neben Lager {id} und seine Höhe messen",),
                confirm=(
                    "Niedrige Metalltemperatur an Lager {id}",
                    "Schwingung bei etwas weniger als der halben Drehfrequenz",
                ),
                not_determined=("Um wie viel Lager {id} entlastet ist",),
            ),
        },
        size_words,
    ),
    FindingRule(
        "heavy_load",
        AlertRule("heavy_load"),
        {"de": "zu hohe Lagerlast"},
        {
            "en": FindingTexts(
                what="Bearing {id} carries more than 5 MPa of its area, the most that white metal takes (ISO 7902-3), "
                "{compared}, since {since}",
                check=("Metal temperature of bearing {id} now, and its alarm limit",),
                in_operation=("Reduce load where operations can; watch the metal temperature of bearing {id} in every shift",),
                at_next_stop=("Measure the alignment beside bearing {id} and its elevation; look at its white metal",),
                confirm=("High metal temperature at bearing {id}",),
                not_determined=("By how much bearing {id} is beyond that",),
            ),
            "de": FindingTexts(
                what="Lager {id} trägt mehr als 5 MPa seiner Fläche, das Höchste, was Weißmetall verträgt (ISO 7902-3), "
                "{compared}, seit {since}",
                check=("Metalltemperatur von Lager {id} jetzt, und ihr Alarmgrenzwert",),
                in_operation=(
                    "Last verringern, wo der Betrieb es kann; Metalltemperatur von Lager {id} in jeder Schicht beobachten",
                ),
                at_next_stop=("Ausrichtung neben Lager {id} und seine Höhe messen; sein Weißmetall ansehen",),
                confirm=("Hohe Metalltemperatur an Lager {id}",),
                not_determined=("Um wie viel Lager {id} darüber liegt",),
            ),
        },
        size_words,
    ),
    FindingRule(
        "low_stability",
        AlertRule("low_stability"),
        {"de": "geringe Stabilität"},
        {
            "en": FindingTexts(
                what="The machine is close to whirling in its oil films: at running speed its least damped mode has a "
                "logarithmic decrement below 0.1 (API 617), and less than half of what it had with such oil, {compared}, "
                "since {since}",
                check=(
                    "Vibration below running speed, in a spectrum of another instrument",
                    "What has changed beside it: an alignment, a clearance, the oil and its temperature",
                ),
                in_operation=("Keep oil temperature within its limits, and do not raise the speed while this stands",),
                at_next_stop=("Measure alignment, clearances and elevations of the bearings that carry least", NEW_BASELINE),
                confirm=("Vibration at somewhat less than half the running speed",),
                not_determined=("Which bearing it begins in",),
            ),
            "de": FindingTexts(
                what="Die Maschine ist nahe am Ölwirbel in ihren Schmierfilmen: bei Betriebsdrehzahl hat ihre am wenigsten "
                "gedämpfte Eigenform ein logarithmisches Dekrement unter 0,1 (API 617), und weniger als die Hälfte dessen, "
                "was sie mit solchem Öl hatte, {compared}, seit {since}",
                check=(
                    "Schwingung unter der Drehfrequenz, im Spektrum eines anderen Geräts",
                    "Was sich daneben geändert hat: eine Ausrichtung, ein Lagerspiel, das Öl und seine Temperatur",
                ),
                in_operation=("Öltemperatur in ihren Grenzen halten, und die Drehzahl nicht erhöhen, solange dies besteht",),
                at_next_stop=("Ausrichtung, Lagerspiele und Höhen der Lager messen, die am wenigsten tragen", NEW_BASELINE_DE),
                confirm=("Schwingung bei etwas weniger als der halben Drehfrequenz",),
                not_determined=("In welchem Lager es beginnt",),
            ),
        },
        size_words,
    ),
    *ROTOR_FINDINGS,
)

RATE_RULE = FindingRule(
    "rate_of_change",
    RATE_OF_CHANGE,
    {"de": "Änderungsrate"},
    {
        "en": FindingTexts(
            what="{parameter} drifts by {size} over the last {runs} runs",
            check=(
                "Whether load, temperature or oil drift with it: then an operating condition in the document takes that out",
            ),
            in_operation=("Take run-downs more often while it drifts",),
            at_next_stop=("Look at {element}",),
            if_danger=("Agree with operations on a stop for {element} before its limit is reached",),
            confirm=("A drift that goes on in the next runs, under the same load and temperature",),
            not_determined=("What causes the drift: the diagnosis says so once it is sure",),
        ),
        "de": FindingTexts(
            what="{parameter} driftet um {size} über die letzten {runs} Läufe",
            check=("Ob Last, Temperatur oder Öl mitdriften: dann nimmt eine Betriebsbedingung im Dokument das heraus",),
            in_operation=("Öfter Ausläufe aufnehmen, solange es driftet",),
            at_next_stop=("{element} ansehen",),
            if_danger=("Mit dem Betrieb einen Stillstand für {element} vereinbaren, bevor der Grenzwert erreicht ist",),
            confirm=("Eine Drift, die in den nächsten Läufen bei gleicher Last und Temperatur weitergeht",),
            not_determined=("Was die Drift verursacht: die Diagnose sagt es, sobald sie sicher ist",),
        ),
    },
    rate_words,
    places=("parameter",),
)
"""Declaration of how drifts are reported."""
