"""Serves the quality of a run: the points left out of its identification, with the reasons."""

from fastapi import APIRouter

from estimator.phasors.quality import MEANING, Flag
from service.api.conventions.dependencies import Number, Reading
from service.api.conventions.problems import RESPONSES
from service.api.measurements import schemas
from service.security.requirement import VIEWER
from storage.machines import machines
from storage.measurements import runs

router = APIRouter(tags=["measurements"], responses=RESPONSES, dependencies=[VIEWER])


@router.get("/runs/{run_id}/quality", operation_id="read_run_quality")
def read_run_quality(session: Reading, run_id: Number) -> schemas.RunQuality:
    """Read reasons per point and channel, noise per channel, and findings about the run; empty until it was assessed.

    The points are those of the run's phasors, in the same order.
    """
    row = runs.get(session, run_id)
    found = row.quality or {}
    flags = runs.flags(session, run_id)
    channels = found.get("channels") or list(machines.document(session, row.machine_id, row.revision).channels)
    columns = [] if flags is None else [[_labels(value) for value in column] for column in flags.T.tolist()]
    return schemas.RunQuality(
        run=run_id,
        judged=row.quality is not None,
        points=found.get("points", 0),
        usable=found.get("usable", 0),
        counts=found.get("counts", {}),
        meaning={one.label: MEANING[one] for one in Flag if one.label in found.get("counts", {})},
        findings=found.get("findings", []),
        channels=channels,
        reasons=columns,
        noise={channel: schemas.ChannelNoise(**noise) for channel, noise in found.get("noise", {}).items()},
    )


def _labels(value: int) -> list[str]:
    return [one.label for one in Flag if value & one]
