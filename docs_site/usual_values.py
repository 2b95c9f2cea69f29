"""Usual values of fields of the machine document that no document in `examples/` gives: a hint, no bound."""

from collections.abc import Mapping

WRITTEN_BY_CALIBRATE = "as `rundown calibrate` writes it"
OF_A_BEARING = "as of a bearing"
COEFFICIENTS = ("kxx", "kxy", "kyx", "kyy", "cxx", "cxy", "cyx", "cyy")

USUAL: Mapping[tuple[str, str], str] = {
    ("StaticLoad", "station"): "0 to the shaft's length",
    ("StaticLoad", "force_x"): "up to the weight of the rotor",
    ("StaticLoad", "force_y"): "up to the weight of the rotor",
    ("StaticLoad", "force_x_spread"): "0.05 to 0.2 times the force",
    ("StaticLoad", "force_y_spread"): "0.05 to 0.2 times the force",
    ("StaticLoad", "stated_at"): "100 for a load in %",
    ("Probe", "gain_spread"): "0.02 to 0.1 of a chain that was not calibrated",
    ("Probe", "run_out_spread"): "2e-06 to 1e-05",
    ("Condition", "usual_change"): "5 to 20",
    ("Operation", "stopped_below_rpm"): "10 to 60",
    ("Operation", "controlled_deceleration_rpm_per_s"): "20 to 100",
    ("Operation", "vibration_limit"): "1e-05 to 3e-05",
    ("Operation", "vibration_alert"): "3e-05 to 6e-05",
    ("Operation", "vibration_danger"): "5e-05 to 1.2e-04",
    ("Collection", "delta_rpm"): "5 to 20",
    ("Collection", "delta_s"): "1 to 60",
    ("Calibration", "values"): WRITTEN_BY_CALIBRATE,
    ("Calibration", "covariance"): WRITTEN_BY_CALIBRATE,
    ("MountingSpread", "rms"): WRITTEN_BY_CALIBRATE,
    ("ChannelScatter", "rpm"): WRITTEN_BY_CALIBRATE,
    ("ChannelScatter", "rms"): WRITTEN_BY_CALIBRATE,
    ("CalibrationRunRecord", "samples"): WRITTEN_BY_CALIBRATE,
    ("CalibrationRunRecord", "mountings"): WRITTEN_BY_CALIBRATE,
    ("ImpactTest", "frequencies_hz"): "10 to 500",
    **{(part, name): OF_A_BEARING for part in ("Table", "ColumnsAtLoad") for name in COEFFICIENTS},
    ("Table", "speed_rpm"): "over the speed range",
    ("Table", "load"): "the static load on the bearing as it runs",
    ("Table", "scale_spread"): "0.1 to 0.3",
    ("ColumnsAtLoad", "load"): "half to twice the static load on the bearing",
    ("JournalForm", "viscosity_ratio_spread"): "0.1 to 0.3",
    ("JournalForm", "viscosity_slope_spread"): "0.1 to 0.3",
    ("JournalFilm", "valid_above_rpm"): "where the jacking oil is shut off",
    ("Elevation", "x"): "up to 5e-04 either way",
    ("Elevation", "y"): "up to 5e-04 either way",
    ("AlignmentTolerance", "offset"): "2e-05 to 1e-04",
    ("AlignmentTolerance", "angle"): "2e-04 to 1e-03",
    ("Oil", "inlet_c"): "35 to 50",
    ("CouplingPosition", "offset_vertical"): "up to 5e-04 either way",
    ("CouplingPosition", "offset_horizontal"): "up to 5e-04 either way",
    ("CouplingPosition", "angle_vertical"): "up to 1e-03 either way",
    ("CouplingPosition", "angle_horizontal"): "up to 1e-03 either way",
}
"""By part and field."""
