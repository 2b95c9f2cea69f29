"""Texts that several findings share, in each language."""

BALANCE_FIRST = (
    "Do not balance coupling {id}'s machines before: weights would hide the cause and not mend it (common practice)"
)
BALANCE_FIRST_DE = (
    "Maschinen an Kupplung {id} vorher nicht auswuchten: Ausgleichsmassen würden die Ursache verdecken und nicht beheben "
    "(gängige Praxis)"
)
NEW_BASELINE = "After the work, enter a maintenance on the machine's timeline: a new baseline begins"
NEW_BASELINE_DE = "Nach der Arbeit eine Wartung in die Chronik der Maschine eintragen: ein neuer Referenzzustand beginnt"
TAKE_RUN_DOWN = "Take a run-down at the next chance: it shows whether the change grows"
TAKE_RUN_DOWN_DE = "Bei nächster Gelegenheit einen Auslauf aufnehmen: er zeigt, ob die Änderung wächst"
