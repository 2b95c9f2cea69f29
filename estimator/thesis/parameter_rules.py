"""Rules that choose the parameter of Tikhonov's regularisation, which thesis §6.5 asks for.

Generalised cross-validation is of Golub, Heath and Wahba (1979, doi:10.1080/00401706.1979.10489751), the corner of the L-curve
of Hansen and O'Leary (1993, doi:10.1137/0914086); `estimator.thesis.tikhonov` has both.
"""

from typing import Literal

RegularisationRule = Literal["generalised cross-validation", "L-curve"]
"""Name of a rule."""
