"""Findings of rotors, probes and the data themselves: alert rules with the sources of their limits, names and texts."""

from service.monitoring.rules.finding_rule import AlertRule, FindingRule
from service.monitoring.rules.limit_rule import Level, Rule
from service.wording.finding_texts import FindingTexts
from service.wording.finding_words import coupling_run_out_words, run_out_words, sensor_words, size_words, unbalance_words
from service.wording.repeated_texts import (
    BALANCE_FIRST,
    BALANCE_FIRST_DE,
    NEW_BASELINE,
    NEW_BASELINE_DE,
    TAKE_RUN_DOWN,
    TAKE_RUN_DOWN_DE,
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

ROTOR_FINDINGS: tuple[FindingRule, ...] = (
    FindingRule(
        "unbalance",
        UNBALANCE,
        {"de": "Unwucht"},
        {
            "en": FindingTexts(
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
            "de": FindingTexts(
                what="Die Unwucht von Scheibe {id} hat sich geändert um {size}, {compared}, seit {since}",
                check=(
                    "Ob sich 1× an den Aufnehmern bei Scheibe {id} auf einmal oder langsam geändert hat: ein verlorenes Teil, "
                    "oder Ablagerungen und Erosion",
                    "Was sich am {since} geändert hat: ein Anfahren, eine Abschaltung, eine Wäsche, eine Last, eine "
                    "Temperatur",
                ),
                in_operation=(
                    "Kam sie auf einmal, wie ein verlorenes Teil behandeln, bis das Gegenteil gezeigt ist (gängige Praxis)",
                ),
                at_next_stop=(
                    "An Scheibe {id} nach verlorenen Teilen, Ablagerungen und Anstreifspuren suchen",
                    "Im Betriebszustand auswuchten, wo nichts gefunden wird",
                    NEW_BASELINE_DE,
                ),
                if_danger=("Mit dem Betrieb einen Stillstand vereinbaren; kam sie auf einmal, vor dem nächsten Anfahren",),
                confirm=(
                    "Ein fehlendes Teil oder eine Ablagerung beim Winkel der Änderung",
                    "1×, das fällt, wenn Scheibe {id} gereinigt oder ausgewuchtet ist",
                ),
                not_determined=("Was die Ursache ist: ein Verlust, Ablagerungen oder eine Verformung der Scheibe",),
            ),
        },
        unbalance_words,
    ),
    FindingRule(
        "rotating_coupling",
        ROTATING_COUPLING,
        {"de": "Rundlauf der Kupplung"},
        {
            "en": FindingTexts(
                what="The run-out of coupling {id} has changed, {size}: it turns with the shaft, whatever the speed, "
                "{compared}, since {since}",
                check=(
                    "What was done at coupling {id} at {since}: hubs fitted anew, bolts, spacer or marks that do not match",
                ),
                in_operation=(TAKE_RUN_DOWN,),
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
            "de": FindingTexts(
                what="Der Rundlauf von Kupplung {id} hat sich geändert, {size}: die Abweichung dreht mit der Welle, bei jeder "
                "Drehzahl, {compared}, seit {since}",
                check=(
                    "Was am {since} an Kupplung {id} getan wurde: Naben neu aufgezogen, Schrauben, Zwischenstück oder "
                    "Markierungen, die nicht zusammenpassen",
                ),
                in_operation=(TAKE_RUN_DOWN_DE,),
                at_next_stop=(
                    "Rund- und Planlauf beider Naben von Kupplung {id} mit Messuhren messen, während die Welle gedreht wird",
                    "An Kupplung {id} nach schief sitzender Nabe, falschen Schraubenlängen und Schmutz in der Zentrierung "
                    "suchen",
                    BALANCE_FIRST_DE,
                    NEW_BASELINE_DE,
                ),
                if_danger=("Mit dem Betrieb den frühesten Stillstand für Kupplung {id} vereinbaren",),
                confirm=("Ein Rund- oder Planlauf von Kupplung {id}, der beim gleichen Winkel abweicht",),
                not_determined=("Welche der beiden Naben von Kupplung {id} es ist",),
            ),
        },
        coupling_run_out_words,
    ),
    FindingRule(
        "bow",
        RUN_OUT,
        {"de": "Wellenkrümmung"},
        {
            "en": FindingTexts(
                what="The bow, or the run-out at all probes, of shaft {id} has changed by {size}, {compared}, since {since}",
                check=("Slow roll of shaft {id}, cold and hot, and how it stood before the start",),
                in_operation=(
                    "Let shaft {id} turn slowly until its slow roll is steady, before the next start (common practice)",
                ),
                at_next_stop=("Measure the run-out of shaft {id} with a dial gauge along its length",),
                confirm=("A run-out by dial gauge that is as large", "A slow roll that falls while shaft {id} turns slowly"),
                not_determined=("Whether shaft {id} is bent for good or by heat only",),
            ),
            "de": FindingTexts(
                what="Die Krümmung, oder der Runout an allen Aufnehmern, von Welle {id} hat sich geändert um {size}, "
                "{compared}, seit {since}",
                check=("Slow-Roll von Welle {id}, kalt und warm, und wie sie vor dem Anfahren stand",),
                in_operation=(
                    "Welle {id} langsam drehen lassen, bis ihr Slow-Roll ruhig ist, vor dem nächsten Anfahren (gängige "
                    "Praxis)",
                ),
                at_next_stop=("Rundlauf von Welle {id} mit einer Messuhr über ihre Länge messen",),
                confirm=(
                    "Ein Rundlauf nach Messuhr, der ebenso groß ist",
                    "Ein Slow-Roll, der fällt, während Welle {id} langsam dreht",
                ),
                not_determined=("Ob Welle {id} bleibend oder nur durch Wärme krumm ist",),
            ),
        },
        run_out_words,
    ),
    FindingRule(
        "run_out",
        RUN_OUT,
        {"de": "Runout"},
        {
            "en": FindingTexts(
                what="The run-out at probe {id} has changed by {size}, {compared}, since {since}",
                check=("The shaft's surface under probe {id}: scratches, rust, magnetism",),
                in_operation=("Record slow-roll vectors anew at the next run-down and subtract them",),
                at_next_stop=("Clean or burnish the track under probe {id}; look at its holder",),
                confirm=("A slow roll at probe {id} that has changed while its neighbours have not",),
                not_determined=("Whether surface, magnetism or holder is the cause",),
            ),
            "de": FindingTexts(
                what="Der Runout an Aufnehmer {id} hat sich geändert um {size}, {compared}, seit {since}",
                check=("Wellenoberfläche unter Aufnehmer {id}: Kratzer, Rost, Magnetismus",),
                in_operation=("Slow-Roll-Vektoren beim nächsten Auslauf neu aufnehmen und abziehen",),
                at_next_stop=("Messspur unter Aufnehmer {id} reinigen oder glätten; seinen Halter ansehen",),
                confirm=("Ein Slow-Roll an Aufnehmer {id}, der sich geändert hat, während seine Nachbarn gleich blieben",),
                not_determined=("Ob Oberfläche, Magnetismus oder Halter die Ursache ist",),
            ),
        },
        run_out_words,
    ),
    FindingRule(
        "sensor",
        SENSOR,
        {"de": "Messkette"},
        {
            "en": FindingTexts(
                what="Probe {id} {size}, {compared}, since {since}",
                check=(
                    "Gap voltage, connectors, cable and driver of probe {id}",
                    "Settings of the channel {id} in its instrument",
                ),
                in_operation=(
                    "Do not act on what channel {id} says by itself; take it out of alarms by the site's own rules",
                ),
                at_next_stop=("Calibrate probe {id} with its own cable and driver, or replace them",),
                confirm=("A calibration curve of probe {id} that is off by as much",),
                not_determined=("Which part of the chain it is: probe, cable, driver or input",),
            ),
            "de": FindingTexts(
                what="Aufnehmer {id} {size}, {compared}, seit {since}",
                check=(
                    "Spaltspannung, Stecker, Kabel und Oszillator (Driver) von Aufnehmer {id}",
                    "Einstellungen des Kanals {id} im Gerät",
                ),
                in_operation=(
                    "Nicht auf das allein handeln, was Kanal {id} sagt; ihn nach den Regeln des Werks aus Alarmen nehmen",
                ),
                at_next_stop=("Aufnehmer {id} mit eigenem Kabel und Oszillator kalibrieren, oder sie ersetzen",),
                confirm=("Eine Kalibrierkurve von Aufnehmer {id}, die um ebenso viel abweicht",),
                not_determined=("Welcher Teil der Messkette es ist: Aufnehmer, Kabel, Oszillator oder Eingang",),
            ),
        },
        sensor_words,
    ),
    FindingRule(
        "misfit",
        AlertRule("misfit"),
        {"de": "Modell passt nicht"},
        {
            "en": FindingTexts(
                what="No fit explains the machine's newest runs: its model does not hold any more, or its data are wrong, "
                "{compared}, since {since}",
                check=(
                    "Residuals of the newest identification: one channel, one speed range, or everywhere",
                    "What was changed at the machine, its instruments or its document at {since}",
                ),
                in_operation=(
                    "Compare 1× with a run from before {since} by eye, and judge the machine by its vibration limits",
                ),
                at_next_stop=("Look at instruments first, then at supports and couplings",),
                confirm=("A fit that is accepted again once the channel or the document is mended",),
                not_determined=("Whether machine, instruments or document is the cause",),
            ),
            "de": FindingTexts(
                what="Keine Anpassung erklärt die neuesten Läufe der Maschine: ihr Modell gilt nicht mehr, oder ihre Daten "
                "sind falsch, {compared}, seit {since}",
                check=(
                    "Residuen der neuesten Identifikation: ein Kanal, ein Drehzahlbereich, oder überall",
                    "Was am {since} an der Maschine, ihren Geräten oder ihrem Dokument geändert wurde",
                ),
                in_operation=(
                    "1× mit einem Lauf vor dem {since} nach Augenmaß vergleichen und die Maschine nach ihren "
                    "Schwingungsgrenzwerten beurteilen",
                ),
                at_next_stop=("Zuerst die Geräte ansehen, dann Abstützungen und Kupplungen",),
                confirm=("Eine Anpassung, die wieder angenommen wird, sobald Kanal oder Dokument berichtigt ist",),
                not_determined=("Ob Maschine, Geräte oder Dokument die Ursache ist",),
            ),
        },
        size_words,
    ),
    FindingRule(
        "outliers",
        AlertRule("outliers"),
        {"de": "Ausreißer"},
        {
            "en": FindingTexts(
                what="Many single phasors of the newest runs do not fit and are left out: look at cables, connections and "
                "interference, {compared}, since {since}",
                check=(
                    "Cables, shields, connectors and the keyphasor",
                    "Welding, drives or radio near the cables at that time",
                ),
                in_operation=("Watch the channel's quality on the run's page",),
                at_next_stop=("Mend cables and earthing; look at gap and surface of the keyphasor's mark",),
                confirm=("Phasors that fit again once a cable or connection is mended",),
                not_determined=("Which cable or source of interference it is",),
            ),
            "de": FindingTexts(
                what="Viele einzelne Zeiger der neuesten Läufe passen nicht und sind ausgelassen: Kabel, Verbindungen und "
                "Störungen ansehen, {compared}, seit {since}",
                check=(
                    "Kabel, Schirme, Stecker und Keyphasor",
                    "Schweißarbeiten, Umrichter oder Funk nahe den Kabeln zu dieser Zeit",
                ),
                in_operation=("Güte des Kanals auf der Seite des Laufs beobachten",),
                at_next_stop=("Kabel und Erdung instand setzen; Spalt und Oberfläche der Keyphasor-Marke ansehen",),
                confirm=("Zeiger, die wieder passen, sobald ein Kabel oder eine Verbindung instand gesetzt ist",),
                not_determined=("Welches Kabel oder welche Störquelle es ist",),
            ),
        },
        size_words,
    ),
)
"""Declarations of `FINDING_RULES`, in the order of display."""
