"""Findings of trains on oil films: alert rules with the sources of their limits, names and texts."""

from service.monitoring.rules.finding_rule import AlertRule, FindingRule
from service.monitoring.rules.limit_rule import Level, Rule
from service.wording.finding_texts import FindingTexts
from service.wording.finding_words import oil_words, process_force_words, settlement_in_words, size_words, wear_in_words
from service.wording.repeated_texts import NEW_BASELINE, NEW_BASELINE_DE

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

OIL_FILM_FINDINGS: tuple[FindingRule, ...] = (
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
        settlement_in_words,
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
        wear_in_words,
    ),
    FindingRule(
        "oil",
        OIL,
        {"en": "oil viscosity", "de": "Ölviskosität"},
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
        {"en": "static force", "de": "Prozesskraft"},
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
                what="Die Prozesskraft {id} hat sich geändert: {size}, {compared}, seit {since}",
                check=("Leistung, Ventile und Drücke seit {since}: woher die Prozesskraft {id} kommt",),
                in_operation=("Einen Auslauf bei üblicher Leistung aufnehmen: er zeigt, ob die Prozesskraft {id} ihr folgt",),
                at_next_stop=(
                    "Ventile, Düsen, Zähne oder Rohre ansehen, von denen die Prozesskraft {id} kommt",
                    NEW_BASELINE_DE,
                ),
                confirm=("Eine Leistung oder ein Druck, die sich mit ihr geändert haben",),
                not_determined=(
                    "Was die Prozesskraft {id} ändert",
                    "Eine Kraft, für die im Dokument keine statische Last steht",
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
                what="Bearing {id} carries more than 5 MPa of its projected area, the most that white metal takes "
                "(ISO 7902-3), {compared}, since {since}",
                check=("Metal temperature of bearing {id} now, and its alarm limit",),
                in_operation=("Reduce load where operations can; watch the metal temperature of bearing {id} in every shift",),
                at_next_stop=("Measure the alignment beside bearing {id} and its elevation; look at its white metal",),
                confirm=("High metal temperature at bearing {id}",),
                not_determined=("By how much bearing {id} is beyond that",),
            ),
            "de": FindingTexts(
                what="Lager {id} trägt mehr als 5 MPa, bezogen auf seine projizierte Fläche: das Höchste, was Weißmetall "
                "verträgt (ISO 7902-3), {compared}, seit {since}",
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
                what="Die Maschine ist nahe am Ölwirbel in ihren Ölfilmen: bei Betriebsdrehzahl hat ihre am wenigsten "
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
)
