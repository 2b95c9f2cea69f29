"""Common parts of bearing models: defaults of the forms, and the refusal of models that follow a law over speed."""

from collections.abc import Iterable
from typing import ClassVar, NoReturn

from estimator.arrays import Floats
from estimator.bearings.model import OwnParameter, WholeTrain


class FormDefaults:
    """Base of forms: no parameters beside coefficients, no values and no warnings of their own. A form overrides what it has.

    Attributes:
        own_parameters: Kinds of parameters that its models have beside coefficients: none.
        whole_train: The one model of the coefficients of all bearings of a train together, beside which the form makes none of
            one element alone: none.
        load_field: Field with the static load for which its coefficients are [N]: none.
    """

    own_parameters: ClassVar[tuple[OwnParameter, ...]] = ()
    whole_train: ClassVar[WholeTrain | None] = None
    load_field: ClassVar[str | None] = None

    def nominal(self, term: str, rpm: float) -> float | None:  # noqa: ARG002
        """Return None: the element's own nominal values hold, at every speed.

        Args:
            term: The term, such as `kxx`.
            rpm: Speed [r/min].

        Returns:
            None, instead of a value [SI].
        """
        return None

    def implausible(self) -> Iterable[tuple[str, str]]:
        """Return nothing.

        Returns:
            Nothing.
        """
        return ()

    def warnings(self, lowest_rpm: float, highest_rpm: float) -> Iterable[tuple[str, str]]:  # noqa: ARG002
        """Return no warnings.

        Args:
            lowest_rpm: Lowest speed of the machine [r/min].
            highest_rpm: Its highest speed [r/min].

        Returns:
            Nothing.
        """
        return ()


class NeverLevel:
    """Base of models whose coefficients follow a law over speed, whatever the parameters.

    Attributes:
        law: The law in words, such as "a table over speed".
    """

    law: ClassVar[str]

    def level(self, fitted: Floats) -> NoReturn:  # noqa: ARG002 - whatever they are
        """Return no parameters: the coefficients are not the same at every speed.

        Args:
            fitted: Fitted numbers (C,) of the constant coefficients [-].

        Returns:
            Nothing, ever.

        Raises:
            ValueError: Always.
        """
        raise ValueError(f"coefficients that follow {self.law} cannot be constant")
