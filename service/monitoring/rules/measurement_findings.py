"""Findings of probes and of the data themselves: alert rules with the sources of their limits, names and texts."""

from service.monitoring.rules.finding_rule import AlertRule, FindingRule
from service.monitoring.rules.limit_rule import Level, Rule
from service.wording.finding_texts import FindingTexts
from service.wording.finding_words import run_out_words, sensor_words, size_words

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

MEASUREMENT_FINDINGS: tuple[FindingRule, ...] = (
    FindingRule(
        "run_out",
        RUN_OUT,
        {"en": "run-out", "de": "Runout"},
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
        {"en": "measuring chain", "de": "Messkette"},
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
        {"en": "model does not fit", "de": "Modell passt nicht"},
        {
            "en": FindingTexts(
                what="No fit explains the machine's newest runs: its model does not hold any more, or its data are wrong, "
                "{compared}, since {since}",
                check=(
                    "Residuals of the newest identification: one channel, one speed range, or everywhere",
                    "What was changed at the machine, its instruments or its document on {since}",
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
