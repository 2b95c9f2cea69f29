"""Sentences on calibrations of models, in German."""

from collections.abc import Mapping

CALIBRATIONS: Mapping[str, str] = {
    "{part} % of the phasors unexplained, at most {most} % ({channel})": (
        "{part} % der Zeiger unerklärt, höchstens {most} % ({channel})"
    ),
    "the model does not fit the runs: {rest}": "das Modell passt nicht zu den Läufen: {rest}",
    "are weights, angles and their sense right?": "stimmen Gewichte, Winkel und ihr Zählsinn?",
    "heavier weights or more runs are needed": "schwerere Gewichte oder mehr Läufe sind nötig",
    "are weights, angles, their sense and the phase's right?": "stimmen Gewichte, Winkel, ihr Zählsinn und der der Phase?",
    "mountings differ by {part} % of what the trial weights do, {rest}": (
        "Montagen unterscheiden sich um {part} % dessen, was die Testgewichte bewirken, {rest}"
    ),
    "and go with these": "und im Gleichklang mit diesen",
    "one disc of one mounting by far more than the others": "eine Scheibe einer Montage weit mehr als die anderen",
    "which chance would do as well without any": "was der Zufall auch ganz ohne sie täte",
    "and there are too few mountings to tell them from these": "und es sind zu wenige Montagen, um beides zu trennen",
    "by chance: heavier weights would calibrate better": "zufällig: schwerere Gewichte würden besser kalibrieren",
    "no trial weight was ever put on disc {id}: what it does rests on the model alone": (
        "auf Scheibe {id} saß nie ein Testgewicht: Was sie bewirkt, beruht allein auf dem Modell"
    ),
    "discs {names} always had weights in the same proportion: only the model tells them apart": (
        "Scheiben {names} trugen Gewichte stets im selben Verhältnis: Nur das Modell trennt sie"
    ),
    "{speeds} cannot determine {terms}: held at the document's values, within {part} %": (
        "aus {speeds} nicht zu bestimmen: {terms}, gehalten bei den Werten des Dokuments, innerhalb {part} %"
    ),
    "{count} speeds": "{count} Drehzahlen",
    "{count} speed": "{count} Drehzahl",
    "{id} {kinds} terms": "{id} Koeffizienten ({kinds})",
    "{id} {kinds} term": "{id} Koeffizient ({kinds})",
    "bearing": "Lager",
    "coupling": "Kupplung",
    "pedestal": "Lagerbock",
    "seal": "Dichtung",
    "disc": "Scheibe",
    "the channels read {factor} times what they should on average, which no usual chain does: {rest}": (
        "die Kanäle zeigen im Mittel das {factor}-Fache des Richtigen, was keine übliche Messkette tut: {rest}"
    ),
    "are the trial weights' units right (such as {units}), and the amplitudes'?": (
        "stimmen die Einheiten der Testgewichte (etwa {units}) und die der Amplituden?"
    ),
    "are the units of the trial weights and of the amplitudes right?": (
        "stimmen die Einheiten der Testgewichte und der Amplituden?"
    ),
    "{unit} given as {other}": "{unit} angegeben als {other}",
    "{which} are {ratio} times as heavy as the others: are units mixed (such as {pairs})?": (
        "{which} sind das {ratio}-Fache der anderen: Sind Einheiten gemischt (etwa {pairs})?"
    ),
    "the weights of {which}": "die Gewichte von {which}",
    "the weights on {which}": "die Gewichte auf {which}",
    "run {id} on {disc}": "Lauf {id} auf {disc}",
    "it fits with the weights of {which}, which were given in {unit}, in {other}": (
        "es passt mit den Gewichten von {which}, die in {unit} angegeben waren, in {other}"
    ),
    "it fits with the weights on {which}, which were given in {unit}, in {other}": (
        "es passt mit den Gewichten auf {which}, die in {unit} angegeben waren, in {other}"
    ),
    "it fits with {which}": "es passt mit {which}",
    "the angles of the weights counted the other way round (`disc_scale`)": (
        "den Winkeln der Gewichte andersherum gezählt (`disc_scale`)"
    ),
    "the opposite sign of the phases (`phase_convention`)": "dem anderen Vorzeichen der Phasen (`phase_convention`)",
    "the runs fit {times} times better with {which} exchanged: are leads, discs and columns the right ones?": (
        "die Läufe passen {times}-mal besser, wenn vertauscht wird: {which}. Sind Leitungen, Scheiben und Spalten die "
        "richtigen?"
    ),
    "over {number}": "über {number}",
    "calibration {id} of the model is in force, as revision {revision} of the document": (
        "Kalibrierung {id} des Modells gilt, als Revision {revision} des Dokuments"
    ),
}
