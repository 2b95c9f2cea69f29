"""Draws the train to scale: the position of each part from driver to driven."""

from fastapi import APIRouter
from pydantic import BaseModel, Field

from estimator.machine.document import Machine
from estimator.machine.train_layout import disc_body, shaft_begins
from service.api.conventions.dependencies import MachineId, Reading
from service.api.conventions.problems import RESPONSES
from service.security.requirement import VIEWER
from storage.machines import machines

router = APIRouter(prefix="/machines", tags=["machines"], responses=RESPONSES, dependencies=[VIEWER])


class SectionOut(BaseModel):
    """A piece of shaft of one diameter."""

    shaft: str
    begin: float = Field(description="[m] from the train's driver-side end, as all positions here")
    end: float
    outer_diameter: float = Field(description="[m]")
    inner_diameter: float = Field(description="[m]")


class Spot(BaseModel):
    """Position of a bearing or seal."""

    element: str = Field(description="as in parameters, such as bearing.B1")
    shaft: str
    at: float


class DiscOut(Spot):
    """A disc with the size of a plain steel disc of equal mass and polar inertia; null where the latter is zero."""

    radius: float | None = Field(description="[m]")
    width: float | None = Field(description="[m]")


class CouplingOut(BaseModel):
    """A coupling, located where its driver shaft ends and its driven one begins."""

    element: str
    driver: str
    driven: str
    at: float


class ProbeOut(BaseModel):
    """A probe."""

    channel: str
    shaft: str
    at: float
    angle_deg: float = Field(description="[°] from +x towards +y")


class Drawing(BaseModel):
    """A train to scale, in metres from its driver-side end."""

    machine: str
    revision: int
    length: float = Field(description="[m]")
    sections: list[SectionOut]
    discs: list[DiscOut]
    bearings: list[Spot]
    seals: list[Spot]
    pedestals: list[Spot] = Field(description="each under its bearing")
    couplings: list[CouplingOut]
    probes: list[ProbeOut]


@router.get("/{machine_id}/drawing", operation_id="read_drawing")
def read_drawing(session: Reading, machine_id: MachineId) -> Drawing:
    """Read the positions and sizes of all parts of the train, by the document in force."""
    revision = machines.get(session, machine_id).revision
    return _drawing(machines.document(session, machine_id, revision), revision)


def _drawing(machine: Machine, revision: int) -> Drawing:
    begins = shaft_begins(machine)
    bearings = {one.id: one for one in machine.bearings}
    standing = [(one.id, bearings[one.bearing]) for one in machine.pedestals]
    return Drawing(
        machine=machine.id,
        revision=revision,
        length=sum(shaft.length for shaft in machine.shafts),
        sections=_sections(machine, begins),
        discs=[
            DiscOut(
                element=f"disc.{one.id}",
                shaft=one.shaft,
                at=begins[one.shaft] + one.station,
                radius=disc_body(one).radius,
                width=disc_body(one).width,
            )
            for one in machine.discs
        ],
        bearings=[
            Spot(element=f"bearing.{one.id}", shaft=one.shaft, at=begins[one.shaft] + one.station) for one in machine.bearings
        ],
        seals=[Spot(element=f"seal.{one.id}", shaft=one.shaft, at=begins[one.shaft] + one.station) for one in machine.seals],
        pedestals=[
            Spot(element=f"pedestal.{name}", shaft=one.shaft, at=begins[one.shaft] + one.station) for name, one in standing
        ],
        couplings=[
            CouplingOut(element=f"coupling.{one.id}", driver=one.driver, driven=one.driven, at=begins[one.driven])
            for one in machine.couplings
        ],
        probes=[
            ProbeOut(channel=one.id, shaft=one.shaft, at=begins[one.shaft] + one.station, angle_deg=one.angle_deg)
            for one in machine.probes
        ],
    )


def _sections(machine: Machine, begins: dict[str, float]) -> list[SectionOut]:
    found = []
    for shaft in machine.shafts:
        begin = begins[shaft.id]
        for section in shaft.sections:
            end = begin + section.length
            found.append(
                SectionOut(
                    shaft=shaft.id,
                    begin=begin,
                    end=end,
                    outer_diameter=section.outer_diameter,
                    inner_diameter=section.inner_diameter,
                )
            )
            begin = end
    return found
