"""Warnings of machine documents, in German."""

from collections.abc import Mapping

DOCUMENTS: Mapping[str, str] = {
    "{speed} r/min: few machines are that slow": "{speed} 1/min: so langsam sind wenige Maschinen",
    "was {value} Hz meant, {speed} r/min?": "waren {value} Hz gemeint, {speed} 1/min?",
    "was {value} rad/s meant, {speed} r/min?": "waren {value} rad/s gemeint, {speed} 1/min?",
    "{running} r/min lies below the speed range, {low} to {high} r/min": (
        "{running} 1/min liegt unter dem Drehzahlbereich, {low} bis {high} 1/min"
    ),
    "{inertia} kg m² of {mass} kg is a radius of gyration of {radius} m: usual is {least} to {most} m": (
        "{inertia} kg m² bei {mass} kg ist ein Trägheitsradius von {radius} m: üblich ist {least} bis {most} m"
    ),
    "was {value} {unit} meant, {meant} kg m²?": "waren {value} {unit} gemeint, {meant} kg m²?",
    (
        "{size} kg m shifts the centre of mass of shaft '{shaft}' with its discs, {mass} kg, by {shift} mm: usual is less "
        "than {most} mm"
    ): (
        "{size} kg m verschiebt den Schwerpunkt von Welle '{shaft}' mit ihren Scheiben, {mass} kg, um {shift} mm: üblich ist "
        "weniger als {most} mm"
    ),
    "was {value} {unit} meant, {meant} kg m?": "waren {value} {unit} gemeint, {meant} kg m?",
    "{mass} kg is {times} times a bearing's share of all rotors, {share} kg: usual is {least} to {most} times": (
        "{mass} kg ist das {times}-Fache des Anteils eines Lagers an allen Rotoren, {share} kg: üblich ist das {least}- bis "
        "{most}-Fache"
    ),
    "was {value} t meant, {mass} kg?": "waren {value} t gemeint, {mass} kg?",
    "neither a force nor a spread: it does nothing": "weder eine Kraft noch eine Streuung: sie bewirkt nichts",
    "usual are force_x, force_y [N], up to the rotors' weight": (
        "üblich sind force_x, force_y [N], bis zum Gewicht der Rotoren"
    ),
    "{force} N is {times} times the weight of all rotors, {weight} N: usual is {least} to {most} times": (
        "{force} N ist das {times}-Fache des Gewichts aller Rotoren, {weight} N: üblich ist das {least}- bis {most}-Fache"
    ),
    "was {value} kN meant, {meant} N?": "waren {value} kN gemeint, {meant} N?",
    "{spread} N is {times} times the weight of all rotors, {weight} N: usual is {least} to {most} times the force": (
        "{spread} N ist das {times}-Fache des Gewichts aller Rotoren, {weight} N: üblich ist das {least}- bis {most}-Fache "
        "der Kraft"
    ),
    "{load} N is {times} times a bearing's share of all rotors' weight, {share} N: usual is {least} to {most} times": (
        "{load} N ist das {times}-Fache des Anteils eines Lagers am Gewicht aller Rotoren, {share} N: üblich ist das {least}- "
        "bis {most}-Fache"
    ),
    "{angle} °: probes mostly stand at multiples of {step}°": ("{angle} °: Sensoren stehen meist bei Vielfachen von {step}°"),
    "{width} ° wide grooves: usual is {least} to {most} °": "{width} ° breite Nuten: üblich ist {least} bis {most} °",
    "was {value} rad meant, {degrees} °?": "waren {value} rad gemeint, {degrees} °?",
    "ISO VG {grade}, but bearing {bearing} of the same supply '{supply}' has ISO VG {other}: one supply has one oil": (
        "ISO VG {grade}, aber Lager {bearing} derselben Versorgung '{supply}' hat ISO VG {other}: eine Versorgung hat ein Öl"
    ),
    (
        "{viscosity} Pa s, but bearing {bearing} of the same supply '{supply}' has {other} Pa s: one supply has one oil, "
        "usual is up to twice as much"
    ): (
        "{viscosity} Pa s, aber Lager {bearing} derselben Versorgung '{supply}' hat {other} Pa s: eine Versorgung hat ein Öl, "
        "üblich ist bis zum Doppelten"
    ),
    (
        "'{supply}' is the supply of this bearing alone, '{other}' that of {bearings}: is it the same one, was '{meant}' "
        "meant?"
    ): (
        "'{supply}' ist die Versorgung dieses Lagers allein, '{other}' die von {bearings}: ist es dieselbe, war '{meant}' "
        "gemeint?"
    ),
    "{speed} r/min is near the end of the speed range, {fastest} r/min: few samples would be left": (
        "{speed} 1/min liegt nahe am Ende des Drehzahlbereichs, {fastest} 1/min: wenige Messungen blieben übrig"
    ),
    "{value} {unit} at {speed} r/min stands beside {other}: is its exponent right?": (
        "{value} {unit} bei {speed} 1/min steht neben {other}: stimmt der Exponent?"
    ),
    "{viscosity} Pa s: warm turbine oil has {least} to {most} Pa s, {low} to {high} mPa s (cP)": (
        "{viscosity} Pa s: warmes Turbinenöl hat {least} bis {most} Pa s, {low} bis {high} mPa s (cP)"
    ),
    "was {value} m²/s meant, {meant} Pa s?": "waren {value} m²/s gemeint, {meant} Pa s?",
    "{density} kg/m³: steel has 7850 kg/m³": "{density} kg/m³: Stahl hat 7850 kg/m³",
    "was {value} g/cm³ meant?": "waren {value} g/cm³ gemeint?",
    "{mass} kg is {times} times the mass of shaft '{shaft}', {own} kg: usual is 0.1 to 5 times": (
        "{mass} kg ist das {times}-Fache der Masse von Welle '{shaft}', {own} kg: üblich ist das 0,1- bis 5-Fache"
    ),
    "{force} N is {times} times the weight of all rotors, {weight} N: usual is up to 10 times": (
        "{force} N ist das {times}-Fache des Gewichts aller Rotoren, {weight} N: üblich ist bis zum 10-Fachen"
    ),
    "was {value} g meant, {mass} kg?": "waren {value} g gemeint, {mass} kg?",
    "{elevation} µm is more than the radial clearance, {clearance} µm: usual are some 10 µm": (
        "{elevation} µm ist mehr als das radiale Lagerspiel, {clearance} µm: üblich sind einige 10 µm"
    ),
    "elevations are in m, over the place at which couplings carry nothing": (
        "Höhenlagen sind in m, über der Lage, bei der Kupplungen nichts tragen"
    ),
    "{allowed} {unit}: growth from cold to hot alone passes it": (
        "{allowed} {unit}: schon was von kalt nach warm wächst, überschreitet das"
    ),
    "{allowed} {unit}: no alarm would come in time": "{allowed} {unit}: kein Alarm käme rechtzeitig",
    "usual is {low} to {high} {unit}": "üblich ist {low} bis {high} {unit}",
    (
        "{clearance} µm is {part} of the radius, {radius} m: usual is 0.001 to 0.002 of it, half the difference of the "
        "diameters"
    ): (
        "{clearance} µm ist das {part}-Fache des Radius, {radius} m: üblich ist das 0,001- bis 0,002-Fache, die halbe "
        "Differenz der Durchmesser"
    ),
    "{value} °C: oil is hardly ever above {hottest} °C there": "{value} °C: Öl ist dort kaum je wärmer als {hottest} °C",
    "profile {profile} without preload is a round bore: usual is 0.3 to 0.6": (
        "Profil {profile} ohne Vorspannung ist eine runde Bohrung: üblich ist 0,3 bis 0,6"
    ),
    "was {value} °F meant, {celsius} °C?": "waren {value} °F gemeint, {celsius} °C?",
    "{speed} r/min is not below the end of the speed range, {fastest} r/min: no sample would be left": (
        "{speed} 1/min liegt nicht unter dem Ende des Drehzahlbereichs, {fastest} 1/min: keine Messung bliebe übrig"
    ),
    "{length} m is {part} times the diameter, {diameter} m: usual is 0.3 to 1.2 times": (
        "{length} m ist das {part}-Fache des Durchmessers, {diameter} m: üblich ist das 0,3- bis 1,2-Fache"
    ),
    "{diameter} m, but shaft '{shaft}' is {thick} m thick at station {station} m: the journal is that part of the shaft": (
        "{diameter} m, aber Welle '{shaft}' ist an der Stelle {station} m {thick} m dick: der Zapfen ist dieser Teil der Welle"
    ),
    "{value} {unit}: usual is {least} to {most}": "{value} {unit}: üblich ist {least} bis {most}",
    "no coupling joins shaft '{shaft}' to shaft '{first}': is one missing?": (
        "keine Kupplung verbindet Welle '{shaft}' mit Welle '{first}': fehlt eine?"
    ),
    "{angle} ° at station {station} m is where probe '{other}' stands: is one of them meant to be elsewhere?": (
        "bei {angle} ° an der Stelle {station} m steht schon Sensor '{other}': soll einer von beiden woanders stehen?"
    ),
    "was {value} N/µm meant?": "waren {value} N/µm gemeint?",
    "was {value} MN m/rad meant?": "waren {value} MN m/rad gemeint?",
    "the table covers {first} to {last} r/min and is held level beyond its ends, {beyond} r/min": (
        "die Tabelle reicht von {first} bis {last} 1/min und gilt jenseits ihrer Enden unverändert, {beyond} 1/min"
    ),
    "from {low} to {high} and from {start} to {end}": "von {low} bis {high} und von {start} bis {end}",
    "from {low} to {high}": "von {low} bis {high}",
    "{load} N: the table covers loads of {least} to {most} N and is held at its end": (
        "{load} N: die Tabelle reicht für Lasten von {least} bis {most} N und gilt an ihrem Ende unverändert"
    ),
    "{value} N/m: bearings usually have 1e5 to 1e9 N/m": "{value} N/m: Lager haben meist 1e5 bis 1e9 N/m",
    "neither in the table nor beside it: {terms}": "weder in der Tabelle noch daneben: {terms}",
    "each is a constant that a fit must find": "jedes ist eine Konstante, die eine Anpassung finden muss",
    "until then a direct term is taken to be as large as its like, a cross-coupled term to be 0": (
        "bis dahin gilt ein direkter Term als so groß wie seinesgleichen, ein Kreuzterm als 0"
    ),
    "was N/µm meant?": "war N/µm gemeint?",
}
