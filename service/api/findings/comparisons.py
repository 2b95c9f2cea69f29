"""Serves correlations between the parameters of an identification, and changes between two identifications."""

from typing import Annotated

import numpy as np
from fastapi import APIRouter, Query, Request
from pydantic import BaseModel, Field
from sqlalchemy.orm import Session

from estimator.machine.film_parameter_names import load_balance
from estimator.trends.deviations import parameter_of
from estimator.trends.parameter_change import ParameterChange, Values, element_changes, parameter_changes
from service.api.conventions.dependencies import Number, Reading
from service.api.conventions.problems import RESPONSES, Unsuitable
from service.api.findings.model import read_identified
from service.identification.stored_model import Identified
from service.security.requirement import VIEWER
from storage.findings import identifications
from storage.tables.findings import IdentificationRow

router = APIRouter(prefix="/identifications", tags=["identifications"], responses=RESPONSES, dependencies=[VIEWER])

STRONG = 0.9
"""Correlation beyond which the data hardly distinguish two coordinates."""
MAXIMUM_PAIRS = 50

ComparedIdentification = Annotated[int, Query(ge=0, le=2**62, description="id of an identification")]


class Pair(BaseModel):
    """Two coordinates that the data hardly distinguish."""

    one: str
    other: str
    correlation: float


class Correlation(BaseModel):
    """Correlation of an identification's coordinates."""

    identification: int
    coordinates: list[str]
    correlation: list[list[float]] = Field(description="-1 to 1; 0 beside one that is known exactly")
    strongest: list[Pair] = Field(description=f"pairs beyond ±{STRONG}, strongest first, at most {MAXIMUM_PAIRS}")


class Change(BaseModel):
    """Change of one coordinate, SI; null where one of the two does not determine it."""

    parameter: str
    first: float | None
    second: float | None
    per_cent: float | None = Field(description="of direct terms and scale factors; null for what may change its sign, too")
    sigma: float | None = Field(description="change over the standard errors of both; null where both are exact, too")


class ElementOut(BaseModel):
    """Joint change of an element's coordinates, with their covariances."""

    element: str
    distance: float = Field(description="squared Mahalanobis distance")
    degrees_of_freedom: int
    probability: float = Field(
        description="of a distance so large while nothing changed and the fits' errors are all there is"
    )


class Comparison(BaseModel):
    """Changes from one identification to another of the same machine."""

    machine: str
    first: int
    second: int
    changes: list[Change]
    elements: list[ElementOut]
    only_first: list[str] = Field(description="coordinates that the second has not")
    only_second: list[str]


@router.get("/compare", operation_id="compare_identifications")
def compare_identifications(
    request: Request, session: Reading, first: ComparedIdentification, second: ComparedIdentification
) -> Comparison:
    """Compare two identifications, per parameter and per element.

    Only the errors of the fits are counted; the baseline shows how much the machine varies from run to run.
    """
    rows = [identifications.get(session, number) for number in (first, second)]
    machine_of = [row.machine_id for row in rows]
    if machine_of[0] != machine_of[1]:
        raise Unsuitable(
            f"only those of one machine: identification {first} is of machine '{machine_of[0]}', {second} of '{machine_of[1]}'"
        )
    _require_same_balance(*rows)
    unknown = [_undetermined(session, number) for number in (first, second)]
    before, after = (_values(read_identified(request, number)) for number in (first, second))
    return Comparison(
        machine=machine_of[0],
        first=first,
        second=second,
        changes=[_change(one, *unknown) for one in parameter_changes(before, after)],
        elements=[
            ElementOut(
                element=one.element,
                distance=one.distance,
                degrees_of_freedom=one.degrees_of_freedom,
                probability=one.probability,
            )
            for one in element_changes(before, after)
        ],
        only_first=[name for name in before.coordinates if name not in after.coordinates],
        only_second=[name for name in after.coordinates if name not in before.coordinates],
    )


@router.get("/{identification_id}/correlation", operation_id="read_correlation")
def read_correlation(session: Reading, identification_id: Number) -> Correlation:
    """Read the correlation of all coordinates, and the pairs that the data hardly distinguish."""
    row = identifications.get(session, identification_id)
    covariance = identifications.covariance(row)
    size = np.sqrt(np.diag(covariance))
    size = np.where(size > 0.0, size, np.inf)
    matrix = np.clip(covariance / np.outer(size, size), -1.0, 1.0)
    upper = np.argwhere(np.triu(np.abs(matrix) > STRONG, 1))
    strongest = sorted(upper.tolist(), key=lambda at: -abs(matrix[at[0], at[1]]))[:MAXIMUM_PAIRS]
    return Correlation(
        identification=identification_id,
        coordinates=row.coordinates,
        correlation=matrix.tolist(),
        strongest=[
            Pair(one=row.coordinates[i], other=row.coordinates[j], correlation=float(matrix[i, j])) for i, j in strongest
        ],
    )


def _require_same_balance(*rows: IdentificationRow) -> None:
    """Raise Unsuitable where one identification balances the loads on oil films otherwise than the other."""
    concerned = [row for row in rows if load_balance(row.coordinates) is not None]
    if len(concerned) == len(rows) and len({row.load_balance for row in concerned}) > 1:
        older = min(concerned, key=lambda row: row.load_balance or 0)
        raise Unsuitable(
            f"identification {older.id} is by a release that balances the loads on oil films otherwise, with other "
            "stiffnesses of couplings and pedestals: identify its run again and compare that"
        )


def _undetermined(session: Session, identification_id: int) -> set[str]:
    """Return the parameters that an identification does not determine, although its model has values for them."""
    return {row.parameter for row in identifications.estimates(session, identification_id) if row.value is None}


def _change(one: ParameterChange, unknown_first: set[str], unknown_second: set[str]) -> Change:
    name = parameter_of(one.name)
    told = name not in unknown_first | unknown_second
    return Change(
        parameter=one.name,
        first=None if name in unknown_first else one.first,
        second=None if name in unknown_second else one.second,
        per_cent=100 * one.relative if told and one.relative is not None else None,
        sigma=one.sigma if told and np.isfinite(one.sigma) else None,
    )


def _values(one: Identified) -> Values:
    return Values(one.coordinates, one.point, one.covariance)
