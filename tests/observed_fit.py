"""Reads of a computed identification what the assessment reads of a stored one."""

from estimator.diagnosis.observation import ObservedFit
from estimator.fit.identification import Identification


def observed_fit(one: Identification) -> ObservedFit:
    """The fit of an identification, as the store gives it back."""
    return ObservedFit(
        coordinates=one.coordinates,
        point=one.point,
        covariance=one.covariance,
        effects=one.channel_effects,
        accepted=one.accepted,
        chi_square=one.chi_square,
        degrees_of_freedom=one.degrees_of_freedom,
        samples=one.samples,
        outliers=one.outliers,
    )
