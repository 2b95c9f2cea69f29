"""Sentences on field balancing, in German."""

from collections.abc import Mapping

BALANCING: Mapping[str, str] = {
    "influence coefficients, {error} ({measure})": "Einflusszahlen, {error} ({measure})",
    "influence coefficients taken, no model predicts clearly better: {listed} ({measure})": (
        "Einflusszahlen verwendet, kein Modell sagt deutlich besser voraus: {listed} ({measure})"
    ),
    "{method} taken, which predicts best: {listed} ({measure})": (
        "{method} verwendet, was am besten voraussagt: {listed} ({measure})"
    ),
    "{method} taken as asked: {listed} ({measure})": "{method} verwendet wie verlangt: {listed} ({measure})",
    "{method} taken": "{method} verwendet",
    "{method} taken as asked": "{method} verwendet wie verlangt",
    # Longer than the form below, which would take "taken" for an error.
    "influence coefficients taken": "Einflusszahlen verwendet",
    "influence coefficients taken as asked": "Einflusszahlen verwendet wie verlangt",
    "influence coefficients": "Einflusszahlen",
    "influence coefficients {of}": "Einflusszahlen {of}",
    "model": "Modell",
    "model {of}": "Modell {of}",
    "corrected model": "berichtigtes Modell",
    "scaled model": "skaliertes Modell",
    "corrected model {of}": "berichtigtes Modell {of}",
    "scaled model {of}": "skaliertes Modell {of}",
    "errors of predicted vectors over what the trial weights changed, runs left out in turn": (
        "Fehler vorausgesagter Zeiger über dem, was die Testmassen änderten, je ein Lauf ausgelassen"
    ),
    "with these trials no run can be left out to compare them with the model": (
        "bei diesen Testläufen lässt sich keiner auslassen, um sie mit dem Modell zu vergleichen"
    ),
    "with these trials no run can be left out to test them": (
        "bei diesen Testläufen lässt sich keiner auslassen, um sie zu prüfen"
    ),
    (
        "{plane} does nearly what other planes together do at the measuring points, only {part} % is its own: weights on it "
        "nearly cancel theirs, and are no better known than their intervals say"
    ): (
        "{plane} wirkt an den Messpunkten fast wie andere Ebenen zusammen, nur {part} % ist ihr eigen: Massen auf ihr heben "
        "sich mit deren fast auf und sind nicht besser bekannt, als ihre Vertrauensbereiche sagen"
    ),
    (
        "{planes} do nearly the same at the measuring points, only {part} % is their own: weights on them nearly cancel, and "
        "are no better known than their intervals say"
    ): (
        "{planes} wirken an den Messpunkten fast gleich, nur {part} % ist ihnen eigen: Massen auf ihnen heben sich fast auf "
        "und sind nicht besser bekannt, als ihre Vertrauensbereiche sagen"
    ),
    (
        "{plane} does nothing at the measuring points that could be told from their scatter: trial weights on it are too "
        "small, or runs contradict each other (was a weight or its angle entered wrongly?)"
    ): (
        "{plane} bewirkt an den Messpunkten nichts, was sich von deren Streuung unterscheiden ließe: Testmassen darauf "
        "sind zu klein, oder Läufe widersprechen einander (wurde eine Masse oder ihr Winkel falsch eingegeben?)"
    ),
    (
        "{plane} cannot be told apart from {others}: only {part} % of what it does at the measuring points is its own. "
        "Weights on both would nearly cancel"
    ): (
        "{plane} lässt sich nicht von {others} unterscheiden: nur {part} % seiner Wirkung an den Messpunkten ist ihm eigen. "
        "Massen auf beiden würden sich fast aufheben"
    ),
    "{others} together": "{others} zusammen",
    "{plane} is left out. Another speed or measuring point may tell them apart": (
        "{plane} ist ausgelassen. Eine andere Drehzahl oder ein anderer Messpunkt könnte sie unterscheiden"
    ),
    (
        "{run} differs from {other} by no more than the error of the vectors: its trial weight is too small, or was entered "
        "in the wrong unit"
    ): (
        "{run} unterscheidet sich von {other} um nicht mehr als den Fehler der Zeiger: die Testmasse ist zu klein oder wurde "
        "in der falschen Einheit eingegeben"
    ),
    "left out, as the runs do not all show them: {points}": "ausgelassen, weil nicht alle Läufe sie zeigen: {points}",
    "{points} and {count} more": "{points} und {count} weitere",
    "{channel} at {speed} r/min": "{channel} bei {speed} 1/min",
    (
        "no trial weight was on {discs}: what their unbalances do counts as if it came from {planes}, in the residual "
        "unbalance, too"
    ): (
        "auf {discs} war keine Testmasse: die Wirkung ihrer Unwuchten zählt, als käme sie von {planes}, auch in der "
        "Restunwucht"
    ),
    "plane {disc} had no trial run": "Ebene {disc} hatte keinen Testlauf",
    "plane {disc} cannot be told apart from others, or from the scatter": (
        "Ebene {disc} lässt sich nicht von anderen oder von der Streuung unterscheiden"
    ),
    "not known": "nicht bekannt",
    (
        "{amount} g mm on {plane} would be G {grade} of its rotor, {mass} kg, where rotors that run are far below: is the "
        "trial weights' unit right?"
    ): (
        "{amount} g mm auf {plane} wären G {grade} des Rotors, {mass} kg, und laufende Rotoren liegen weit darunter: stimmt "
        "die Einheit der Testmassen?"
    ),
    (
        "{run} differs from {other} by {change} µm, where its weights move the centre of mass by {shift} µm: were they "
        "heavier, or in a larger unit?"
    ): (
        "{run} unterscheidet sich von {other} um {change} µm, wo seine Massen den Schwerpunkt um {shift} µm verschieben: "
        "waren sie schwerer oder in einer größeren Einheit?"
    ),
    (
        "no run was repeated: intervals and promises hold the noise of the vectors, but not how the rotor settles anew at "
        "each start"
    ): (
        "kein Lauf wurde wiederholt: Vertrauensbereiche und Zusagen enthalten das Rauschen der Zeiger, aber nicht, wie sich "
        "der Rotor bei jedem Start neu setzt"
    ),
    "a repeated initial run would tell": "ein wiederholter Urlauf würde es zeigen",
    "run {number}": "Lauf {number}",
}
