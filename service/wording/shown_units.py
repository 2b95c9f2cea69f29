"""Units in which vibration and speed are shown, by the names of the page's switch: µm or mil, pp or 0-pk, r/min or Hz."""

from dataclasses import dataclass
from typing import Literal, get_args

from service.wording.language import MIL_UM, Language, LengthUnit

UnitsName = Literal["um_pp,rpm", "um_p,rpm", "mil_pp,rpm", "mil_p,rpm", "um_pp,hz", "um_p,hz", "mil_pp,hz", "mil_p,hz"]
"""Choices, as the page names them."""
CHOICES: tuple[UnitsName, ...] = get_args(UnitsName)
RPM_PER_HZ = 60.0
PEAK_TO_PEAK = 2.0
"""Peak-to-peak of a 0-to-peak amplitude."""


class UnitsUnknown(ValueError):
    """Units that are not a choice."""


@dataclass(frozen=True)
class ShownUnits:
    """Units of lengths, of amplitudes (0-to-peak or peak-to-peak, in the unit of lengths), and of speeds (Hz or r/min)."""

    length: LengthUnit = "µm"
    zero_to_peak: bool = False
    hertz: bool = False

    def in_length(self, micrometres: float) -> float:
        """Return a length [µm] in the unit of lengths."""
        return micrometres if self.length == "µm" else micrometres / MIL_UM

    def amplitude_factor(self) -> float:
        """Return the factor from µm peak-to-peak to the unit of amplitudes."""
        return self.in_length(1.0) / (PEAK_TO_PEAK if self.zero_to_peak else 1.0)

    def speed_factor(self) -> float:
        """Return the factor from r/min to the unit of speeds."""
        return 1.0 / RPM_PER_HZ if self.hertz else 1.0

    def amplitude_label(self) -> str:
        """Return the unit of amplitudes."""
        return f"{self.length} {'0-pk' if self.zero_to_peak else 'pp'}"

    def speed_label(self, language: Language) -> str:
        """Return the unit of speeds as a language writes it."""
        return "Hz" if self.hertz else language.named("rpm")

    def speed_number(self, rpm: float, language: Language) -> str:
        """Return a speed [r/min] as a number in the unit of speeds, to 1 r/min or 0.1 Hz."""
        return language.digits(f"{rpm * self.speed_factor():.{1 if self.hertz else 0}f}")

    def speed(self, rpm: float, language: Language) -> str:
        """Return a speed [r/min] with its unit."""
        return f"{self.speed_number(rpm, language)} {self.speed_label(language)}"


USUAL_UNITS = ShownUnits()
"""µm peak-to-peak and r/min."""


def units_of(name: str) -> ShownUnits:
    """Return the units of a choice. Raises UnitsUnknown."""
    if name not in CHOICES:
        raise UnitsUnknown(f"units '{name}' are none of: {'; '.join(CHOICES)}")
    amplitude, speed = name.split(",")
    length, _, reckoned = amplitude.partition("_")
    return ShownUnits("mil" if length == "mil" else "µm", zero_to_peak=reckoned == "p", hertz=speed == "hz")
