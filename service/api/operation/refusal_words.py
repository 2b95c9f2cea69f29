"""Reasons for refusing input in plain words: the meaning of each, and the remedy."""

from collections.abc import Mapping

from formats.wire import InternalErrorReason, Reason

_MEANINGS: dict[Reason | InternalErrorReason, str] = {
    "too_large": "the message is larger than what is taken: send fewer samples in each",
    "bad_frame": "the message was cut off or damaged on its way: look at the network and at who wrote it",
    "undecodable": "the message cannot be read: look at its format and encoding",
    "future_schema": "the sender is newer than this service: update the service first",
    "key_mismatch": "the message names another machine than its key: correct the sender's configuration",
    "unknown_machine": "it names a machine that there is not: create it from its document, or correct the name",
    "unknown_channel": "it names a channel that the machine's document does not have: correct either",
    "unknown_condition": "it names an operating condition that the machine's document does not have: correct either",
    "wrong_unit": "it names a unit that is not known: correct the sender's configuration",
    "wrong_shape": "its parts do not match in number: look at the sender",
    "not_finite": "a value is no number: look at the sensor and its wiring",
    "speed_out_of_range": "the speed is beyond what the machine can reach: look at its unit, and at the pulses per turn",
    "speed_out_of_order": "the speed jumps as no rotor can: look at the keyphasor",
    "amplitude_out_of_range": "the vibration is larger than a probe can see: look at its unit",
    "sequence_out_of_range": "the numbers of the samples jump: restart the source, which then begins anew",
    "time_out_of_range": "the time is wrong: set the source's clock, and send nanoseconds since 1970",
    "time_out_of_order": "times go back: look at the source's clock",
    "gap_out_of_range": "the gap lies beyond what a probe can see, and is left out: look at its unit and sign",
    "gap_undescribed": "the document does not say which way the probe's gap grows, so it is left out: add `gap_grows`",
    "overall_out_of_range": "the overall level is larger than a probe can see, and is left out: look at its unit",
    "retained": "the broker kept the message, and its age is unknown: publish samples without the retain flag",
    "unexpected_error": "the service failed at it: its log says why",
    "damaged_block": "the disk has damaged what was stored: restore a backup",
}
MEANINGS: Mapping[str, str] = {str(reason): words for reason, words in _MEANINGS.items()}
"""Meaning of each reason, and what to do."""
OF_AN_OLDER_RELEASE = "an older release refused it: its detail says why"


def refusal_words(reason: str) -> str:
    """Return what a reason means and what to do."""
    return MEANINGS.get(reason, OF_AN_OLDER_RELEASE)
