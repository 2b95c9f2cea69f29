"""Requests and answers of calibrations of a machine's model."""

from datetime import datetime
from typing import Annotated, Self

from pydantic import BaseModel, Field, model_validator

from estimator.machine.calibration import GainDrift
from estimator.machine.disc_scale import DiscScale
from estimator.machine.document import Machine
from estimator.strict_model import StrictModel
from service.api.conventions.fields import Comment, DisplayName
from service.api.machines.balancing_schemas import RunNumber, Weights, required
from service.security.principal import Author


class CalibrationRunIn(StrictModel):
    """A stored run with all weights that were on."""

    model_config = required("run", "weights")

    run: RunNumber
    weights: Weights = Field(
        default=None,
        validate_default=True,
        description="all that was on, also what an earlier trial left; an empty list says that there was none",
    )
    mounting: DisplayName | None = Field(
        default=None, description="runs with the same name were not dismounted between; by default each run is one of its own"
    )
    steady: bool = Field(
        default=False,
        description="samples are dwells at constant speed, of no sweep: such a run may have been discarded as one; "
        "`POST /machines/{machine_id}/runs` makes one",
    )


class ModelCalibrationIn(StrictModel):
    """Runs with known unbalances: stated here, or those of a field balancing with its trial weights, or both."""

    runs: Annotated[list[CalibrationRunIn], Field(max_length=200)] = Field(default_factory=list)
    disc_scale: DiscScale = Field(
        default=DiscScale(),
        description="on which the angles of weights are said; by default from the keyphasor mark, +x to +y",
    )
    balancing: RunNumber | None = Field(default=None, description="whose initial, trial and check runs are used")
    seed: int = Field(default=0, ge=0, le=2**31, description="of the random starts")
    comment: Comment = ""
    by: Author

    @model_validator(mode="after")
    def _require_content(self) -> Self:
        if not self.runs and self.balancing is None:
            raise ValueError(
                "a calibration needs runs: one as the machine is (`weights: []`) and one with a known unbalance at least, or "
                "the `balancing` that has them"
            )
        return self


class CalibrationInForceIn(StrictModel):
    """Putting a calibration in force, with the person who does so."""

    gain_drift: GainDrift = 0.0
    by: Author


class CalibrationWeightOut(BaseModel):
    """An unbalance on a disc."""

    disc: str
    g_mm: float
    angle_deg: float = Field(description="from the keyphasor mark, +x to +y [°]")


class CalibrationRunOut(BaseModel):
    """A run of a calibration with all weights that were on."""

    run: int
    weights: list[CalibrationWeightOut]
    mounting: str | None
    steady: bool


class ModelCalibrationSummary(BaseModel):
    """A calibration: what was asked, how far it is, and what came of it."""

    id: int
    machine: str
    revision: int = Field(description="of the document that it begins from")
    job: int | None
    state: str = Field(description="of its job: queued, running, done, failed or quarantined")
    error: str | None
    by: str
    comment: str
    created_at: datetime
    computed_at: datetime | None
    accepted: bool | None = Field(description="whether it may be put in force; null until it is computed")
    verdict: str | None
    remarks: list[str] = Field(description="what the runs could not determine")
    starts: int | None = Field(description="of the fit")
    unique: bool | None = Field(description="whether the best optimum was found twice")
    code_version: str | None = Field(description="release that computed it")
    seed: int
    runs: list[CalibrationRunOut]
    revision_in_force: int | None = Field(description="revision of the document as which it was put in force last")
    in_force: bool = Field(description="whether the document in force holds it")


class ModelCalibrationOut(ModelCalibrationSummary):
    """A calibration with the document that it leads to."""

    document: Machine | None = Field(description="the machine's document with the calibration; null until it is computed")
