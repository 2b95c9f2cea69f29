"""An identification as text for a terminal."""

from estimator.estimates import Estimate
from estimator.identification import Identification
from estimator.units import rad_per_s_to_rpm


def identification_text(result: Identification) -> str:
    """Verdict and estimates ± standard error, a line a parameter."""
    lines = [
        result.verdict,
        f"{result.samples} samples, {rad_per_s_to_rpm(result.speed_minimum):.0f} to "
        f"{rad_per_s_to_rpm(result.speed_maximum):.0f} rpm; {result.starts} start(s), {result.iterations} iterations; "
        f"condition number {result.condition_number:.2g}",
        "",
    ]
    width = max(len(estimate.name) for estimate in result.estimates)
    return "\n".join(lines + [f"{estimate.name:<{width}}  {_value(estimate)}" for estimate in result.estimates])


def _value(estimate: Estimate) -> str:
    if estimate.value is None or estimate.standard_error is None:
        return f"not estimable: {estimate.reason}"
    if estimate.imaginary is not None and estimate.imaginary_standard_error is not None:
        return (
            f"{estimate.value:+.4e} ± {estimate.standard_error:.1e}  "
            f"{estimate.imaginary:+.4e}j ± {estimate.imaginary_standard_error:.1e} {estimate.unit}"
        )
    percent = 100 * estimate.standard_error / abs(estimate.value) if estimate.value else float("inf")
    return f"{estimate.value:+.4e} ± {estimate.standard_error:.1e} {estimate.unit} ({percent:.2g} %)"
