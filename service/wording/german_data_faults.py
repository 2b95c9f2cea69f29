"""Sentences on gaps beside a fit and on wrong conventions of the data, in German."""

from collections.abc import Mapping

DATA_FAULTS: Mapping[str, str] = {
    # --- gaps beside a fit
    "with the shaft centreline of {count} channels, χ²/dof {reduced}": (
        "mit der Wellenlage von {count} Kanälen, χ²/Freiheitsgrad {reduced}"
    ),
    "the shaft centreline is left out: it does not fit together with the vibration, χ²/dof {reduced}": (
        "die Wellenlage ist ausgelassen: sie passt nicht mit der Schwingung zusammen, χ²/Freiheitsgrad {reduced}"
    ),
    (
        "the gap of {channel} jumps by {size} µm at {speed} r/min and is left out: the probe, its holder or its cable has "
        "moved"
    ): (
        "der Spalt von {channel} springt bei {speed} 1/min um {size} µm und ist ausgelassen: der Aufnehmer, sein Halter oder "
        "sein Kabel hat sich bewegt"
    ),
    "the gap of {channel} does not move as the journals do, χ²/dof {reduced}": (
        "der Spalt von {channel} bewegt sich nicht wie die Zapfen, χ²/Freiheitsgrad {reduced}"
    ),
    "the gap of {channel} moves the other way than the journals do: gap_grows is {said} in the document, is it {other}?": (
        "der Spalt von {channel} bewegt sich umgekehrt zu den Zapfen: gap_grows ist {said} im Dokument, ist es {other}?"
    ),
    "the gap of {channel} hardly moves, {ratio} times as the journals do: is its input coupled for direct current?": (
        "der Spalt von {channel} bewegt sich kaum, {ratio}-mal so viel wie die Zapfen: lässt sein Eingang Gleichspannung "
        "durch?"
    ),
    "the gap of {channel} moves {ratio} times as the journals do: are its unit and sensitivity right?": (
        "der Spalt von {channel} bewegt sich {ratio}-mal so viel wie die Zapfen: stimmen seine Einheit und Empfindlichkeit?"
    ),
    "it is left out": "er ist ausgelassen",
    # --- wrong conventions
    "the run fits {times} times better with {what}": "der Lauf passt {times}-mal besser mit {what}",
    "the run fits over {times} times better with {what}": "der Lauf passt über {times}-mal besser mit {what}",
    "the runs fit {times} times better with {what}": "die Läufe passen {times}-mal besser mit {what}",
    "the runs fit over {times} times better with {what}": "die Läufe passen über {times}-mal besser mit {what}",
    "{what} in run {id} of {count} alone": "{what} allein in Lauf {id} von {count}",
    "{what}, or equally well with {others}": "{what}, oder ebenso gut mit {others}",
    "{one} or with {other}": "{one} oder mit {other}",
    "{what}, though something else is wrong too": "{what}, doch ist noch etwas anderes falsch",
    "the opposite sign of the phase: lead sent as lag, or lag as lead": (
        "umgekehrtem Vorzeichen der Phase: Voreilung als Nacheilung gesendet oder umgekehrt"
    ),
    "the opposite sense of rotation": "umgekehrter Drehrichtung",
    "phases in rad that were sent as degrees": "Phasen in rad, die als Grad gesendet wurden",
    "the probes of every pair swapped with each other": "den Aufnehmern jedes Paares untereinander vertauscht",
    "{probes} swapped with each other": "{probes} untereinander vertauscht",
    "0-to-peak amplitudes that were sent as peak-to-peak": "Scheitelwerten, die als Spitze-Spitze-Werte gesendet wurden",
    "peak-to-peak amplitudes that were sent as 0-to-peak": "Spitze-Spitze-Werten, die als Scheitelwerte gesendet wurden",
    "amplitudes in {meant} that were sent as {sent}": "Amplituden in {meant}, die als {sent} gesendet wurden",
    "amplitudes in {meant} that were sent as {sent}?": "Amplituden in {meant}, die als {sent} gesendet wurden?",
    "speeds in {meant} that were sent as {sent}": "Drehzahlen in {meant}, die als {sent} gesendet wurden",
    "speeds in {meant} that were sent as {sent}?": "Drehzahlen in {meant}, die als {sent} gesendet wurden?",
    "it turned at {slowest} to {fastest} r/min, {part} % of {low} to {high} r/min": (
        "sie drehte mit {slowest} bis {fastest} 1/min, {part} % von {low} bis {high} 1/min"
    ),
    "it turned at {slowest} to {fastest} r/min, {part} % of {low} to {high} r/min: {meaning}": (
        "sie drehte mit {slowest} bis {fastest} 1/min, {part} % von {low} bis {high} 1/min: {meaning}"
    ),
    "a run sweeps through it": "ein Lauf durchfährt ihn",
}
