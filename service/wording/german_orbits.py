"""Sentences on orbits, in German."""

from collections.abc import Mapping

ORBITS: Mapping[str, str] = {
    "whether {channels} are swapped cannot be seen: {why}": "ob {channels} vertauscht sind, ist nicht zu sehen: {why}",
    "whether {channel} is swapped cannot be seen: {why}": "ob {channel} vertauscht ist, ist nicht zu sehen: {why}",
    "one probe alone sees no orbit": "ein Aufnehmer allein sieht keine Wellenbahn",
    "the probes look along one line": "die Aufnehmer messen entlang einer Linie",
    "the model's own orbit is forward for {part} % of all unbalances only": (
        "die Wellenbahn des Modells selbst läuft nur für {part} % aller Unwuchten gleichläufig um"
    ),
    "{samples} samples below {speed} r/min, where it is certain": "{samples} Messwerte unter {speed} 1/min, wo es sicher ist",
    "{fewest} are needed": "{fewest} sind nötig",
    "the speeds below {speed} r/min, where it is certain, lie too near to each other": (
        "die Drehzahlen unter {speed} 1/min, wo es sicher ist, liegen zu dicht beieinander"
    ),
    "the orbit is small beside those elsewhere, so it may turn either way": (
        "die Wellenbahn ist klein gegen die anderen und kann daher in beiden Richtungen umlaufen"
    ),
    "the orbit is too flat or too small for the noise": "die Wellenbahn ist zu flach oder zu klein für das Rauschen",
    "the document gives no stiffness of bearing {names}": "das Dokument gibt keine Steifigkeit von Lager {names} an",
    "the document's machine has no critical speed": "die Maschine des Dokuments hat keine kritische Drehzahl",
    "the orbits at all {count} pairs of probes turn backward: the sense of rotation is wrong, or every pair is swapped": (
        "die Wellenbahnen an allen {count} Aufnehmerpaaren laufen gegenläufig um: die Drehrichtung ist falsch, oder jedes "
        "Paar ist vertauscht"
    ),
    "the orbit at {channels} turns backward, not forward: {meaning}": (
        "die Wellenbahn an {channels} läuft gegenläufig um, nicht gleichläufig: {meaning}"
    ),
    "the orbit at {channels} turns backward, not forward, as at {count} of {all} pairs: {meaning}": (
        "die Wellenbahn an {channels} läuft gegenläufig um, nicht gleichläufig, wie an {count} von {all} Paaren: {meaning}"
    ),
    "the orbit at {channels} turns backward, not forward as at the other pairs: {meaning}": (
        "die Wellenbahn an {channels} läuft gegenläufig um, nicht gleichläufig wie an den anderen Paaren: {meaning}"
    ),
    "the channels are swapped, or the sense of rotation is wrong": (
        "die Kanäle sind vertauscht, oder die Drehrichtung ist falsch"
    ),
    "the channels are swapped, or the sense of rotation is wrong and those of the other pairs are swapped": (
        "die Kanäle sind vertauscht, oder die Drehrichtung ist falsch und die der anderen Paare sind vertauscht"
    ),
    "these channels are swapped": "diese Kanäle sind vertauscht",
}
