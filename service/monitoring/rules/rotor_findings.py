"""Findings of rotors: alert rules with the sources of their limits, names and texts."""

from service.monitoring.rules.finding_rule import AlertRule, FindingRule
from service.monitoring.rules.limit_rule import Level, Rule
from service.monitoring.rules.measurement_findings import RUN_OUT
from service.wording.finding_texts import FindingTexts
from service.wording.finding_words import coupling_run_out_words, run_out_words, unbalance_words
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
    mended_by_balancing=("disc",),
)
ROTATING_COUPLING = AlertRule(
    "rotating_coupling",
    # 100 % is a reading of 0.05 mm at rim and face, usually allowed. Rigid couplings pull hard with a tenth of that.
    limits=Rule(alert=Level(sigma=4, tolerance_per_cent=3), danger=Level(tolerance_per_cent=100)),
    quantities=("sigma", "tolerance_per_cent"),
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
                    "What changed on {since}: a start, a trip, a wash, a load, a temperature",
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
        {"en": "rim and face run-out", "de": "Rund- und Planlauf"},
        {
            "en": FindingTexts(
                what="The run-out of coupling {id} has changed, {size}: it turns with the shaft, whatever the speed, "
                "{compared}, since {since}",
                check=(
                    "What was done at coupling {id} on {since}: hubs fitted anew, bolts, spacer or marks that do not match",
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
                what="Der Rundlauf von Kupplung {id} hat sich geändert, {size}: die Abweichung dreht sich mit der Welle, bei "
                "jeder Drehzahl, {compared}, seit {since}",
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
                    "Ein Slow-Roll, der fällt, während sich Welle {id} langsam dreht",
                ),
                not_determined=("Ob Welle {id} bleibend oder nur durch Wärme krumm ist",),
            ),
        },
        run_out_words,
    ),
)
