"""Places to touch for one more finding, delivery channel, bearing model and resource, tests and docs aside.

Each is added to a copy of the packages in as few files as may be, and then has to work there: declared, served, stored.
"""

import os
import re
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.paths import ROOT

PACKAGES = ("estimator", "storage", "formats", "service", "rotorundown")
PAGE = "dashboard/src"
BOUNDS = {"finding": 2, "channel": 2, "bearing model": 2, "model of all bearings": 2, "resource": 5}
"""Most files that each may take."""
LANGUAGES = ("tests/service/wording/test_language.py", "tests/service/test_dashboard_messages.py")
CHECKS = {"finding": LANGUAGES, "channel": LANGUAGES, "resource": ("tests/service/http/test_error_categories.py",)}
"""Tests that must pass with it: of the languages of the service and of the page, of where missing objects are listed."""
PYTEST = ["-q", "-p", "no:cacheprovider", "--import-mode=importlib"]


class Copy:
    """A copy of the packages, and which of its files were written. runs: whether Python runs it, with what is compiled."""

    def __init__(self, folder: Path, *, runs: bool = True) -> None:
        self.folder = folder
        self.touched: set[str] = set()
        for package in PACKAGES:
            # What is compiled holds for the copies as well, but not what another process is writing just now.
            left_out = shutil.ignore_patterns("*.pyc.*" if runs else "__pycache__")
            shutil.copytree(ROOT / package, folder / package, ignore=left_out)
        shutil.copytree(ROOT / PAGE, folder / PAGE)

    def write(self, file: str, text: str) -> None:
        """Write a new file."""
        assert not (self.folder / file).exists(), file
        (self.folder / file).write_text(text)
        self.touched.add(file)

    def insert(self, file: str, behind: str, text: str) -> None:
        """Insert a text behind another, which the file holds once."""
        path = self.folder / file
        content = path.read_text()
        assert content.count(behind) == 1, f"{file} holds {behind!r} {content.count(behind)} times"
        path.write_text(content.replace(behind, behind + text))
        self.touched.add(file)

    def append(self, file: str, text: str) -> None:
        """Append a text to a file."""
        path = self.folder / file
        path.write_text(path.read_text() + text)
        self.touched.add(file)

    def run(self, *arguments: str) -> None:
        """Run Python with arguments on the copy."""
        where = {**os.environ, "PYTHONPATH": f"{self.folder}{os.pathsep}{ROOT}", "PYTHONDONTWRITEBYTECODE": ""}
        done = subprocess.run(
            [sys.executable, *arguments], cwd=self.folder, env=where, capture_output=True, text=True, check=False
        )
        assert done.returncode == 0, done.stdout + done.stderr

    def bring(self, tests: tuple[str, ...]) -> str:
        """Copy files of tests; return a script that runs them, in the process that has loaded the service."""
        for file in tests:
            (self.folder / file).parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(ROOT / file, self.folder / file)
        return f"import pytest\nraise SystemExit(pytest.main({[*PYTEST, *tests]}))\n" if tests else ""


DECLARATIONS = f"""
import pathlib
from service.commands.page_declarations import write
write(pathlib.Path("{PAGE}/declarations"))
"""
"""Writes the page's declarations anew, as `make dashboard` does, in the process that has loaded the service."""


@pytest.fixture
def copy(tmp_path: Path) -> Copy:
    """A copy to add to."""
    return Copy(tmp_path)


def finding(copy: Copy) -> str:
    """Add the finding "rub"; return what has to work with it."""
    copy.insert(
        "estimator/diagnosis/finding_kinds.py",
        "FINDING_KINDS: tuple[FindingKind, ...] = (",
        '\n    FindingKind("rub", ("shaft",), "machine", changes=_bows, size=_run_out_size),',
    )
    copy.insert(
        "service/monitoring/rules/rotor_findings.py",
        "ROTOR_FINDINGS: tuple[FindingRule, ...] = (",
        '\n    FindingRule("rub", AlertRule("rub", Rule(alert=Level(sigma=3.0)), ("sigma",)), {"de": "Anstreifen"}, '
        '{"en": FindingTexts("Shaft {id} rubs: {size}", ("a",), ("b",), ("c",), (), ("e",), ("f",)), '
        '"de": FindingTexts("Welle {id} streift an: {size}", ("g",), ("h",), ("i",), (), ("k",), ("l",))}),',
    )
    return """
from estimator.diagnosis.finding_kinds import finding_kind
from service.commands.openapi import text
from service.commands.page_declarations import documents
from service.monitoring.rules.finding_catalogue import finding_rule, concerned_elements
from service.monitoring.rules.limits import Limits
assert concerned_elements(finding_rule("rub").rule) == ("shaft",)
assert Limits().rule("rub", "shaft.S1").alert.sigma == 3.0
assert '"rub"' in documents()["findings.ts"]
assert '"rub": "Anstreifen"' in documents()["findings.ts"]
assert '"rub"' in text()
"""


def channel(copy: Copy) -> str:
    """Add the channel "logbook"; return what has to work with it."""
    copy.write(
        "service/delivery/logbook.py",
        '''"""Writes alert events to the service's log."""

from service.delivery.channel import DeliveryOutcome, EventMessage
from service.delivery.channel_kind import ChannelKind


class Logbook:
    """Channel to the log."""

    async def send(self, message: EventMessage) -> DeliveryOutcome:
        """Write an event."""
        return DeliveryOutcome("delivered", message.event.message)


LOGBOOK = ChannelKind(
    "logbook", {"en": "Logbook", "de": "Betriebsbuch"}, "none", None, lambda row, connections: Logbook()
)
''',
    )
    copy.insert("service/delivery/channels.py", "CHANNEL_KINDS: tuple[ChannelKind, ...] = (", "LOGBOOK, ")
    copy.insert("service/delivery/channels.py", "from service.delivery.mail import EMAIL\n", f"{LOGBOOK}\n")
    return """
from service.commands.page_declarations import documents
from service.delivery.channels import open_channel
from storage.database.engine import Database
from storage.tables.alerting import SubscriptionRow
from tests.api_in_process import Api
api = Api(Database("sqlite:///subscriptions.db"))
api("POST", "/subscriptions", 201, json={"kind": "logbook", "name": "a"})
assert [one["kind"] for one in api.value("/subscriptions")] == ["logbook"]
assert type(open_channel(SubscriptionRow(kind="logbook"), None)).__name__ == "Logbook"
assert '"Logbook"' in documents()["channels.ts"]
assert '"Betriebsbuch"' in documents()["channels.ts"]
"""


LOGBOOK = "from service.delivery.logbook import LOGBOOK"


def bearing_model(copy: Copy) -> str:
    """Add the form "softening"; return what has to work with it."""
    copy.write(
        "estimator/bearings/softening.py",
        '''"""Coefficients of a bearing whose rubber softens with speed (derived here)."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from estimator.arrays import Floats
from estimator.bearings.defaults import FormDefaults, NeverLevel
from estimator.bearings.model import CoefficientModel, ModelParameter
from estimator.bearings.terms import TERMS
from estimator.field_types import Part, Positive


@dataclass(frozen=True)
class SofteningCurves:
    """A coefficient at some speeds."""

    coefficient: ModelParameter
    factor: Floats

    def values(self, fitted: Floats) -> Floats:
        return self.factor[:, None] * self.coefficient.value(fitted)

    def derivatives(self, fitted: Floats, block: slice) -> Floats:
        return (self.factor[block, None] * self.coefficient.slope(fitted))[..., None]


@dataclass(frozen=True)
class SofteningModel(NeverLevel):
    """A coefficient over 1 + (speed / halving)²."""

    coefficient: ModelParameter
    halving: float
    constant: bool = False
    law = "rubber that softens"

    @property
    def coefficients(self) -> tuple[str, ...]:
        return (self.coefficient.name,)

    @property
    def parameters(self) -> tuple[ModelParameter, ...]:
        return (self.coefficient,)

    def at(self, speed: Floats) -> SofteningCurves:
        return SofteningCurves(self.coefficient, 1.0 / (1.0 + (speed / self.halving) ** 2))


class Softening(FormDefaults, Part):
    """Coefficients that fall to one half at a speed."""

    form: Literal["softening"]
    halving: Positive
    coefficients: tuple[str, ...] | None = None

    def governs(self, term: str) -> bool:
        return term in TERMS

    def parameter_count(self, terms: Sequence[str]) -> int:
        return len(terms)

    def models(self, coefficients: Sequence[ModelParameter]) -> Sequence[CoefficientModel]:
        return [SofteningModel(one, self.halving) for one in coefficients]
''',
    )
    copy.insert("estimator/bearings/registry.py", "FORMS = (", "Softening, ")
    copy.insert(
        "estimator/bearings/registry.py",
        "from estimator.bearings.model import BearingForm, OwnParameter\n",
        "from estimator.bearings.softening import Softening\n",
    )
    return """
import numpy as np
from estimator.fit.problem.train_models import train_models
from estimator.machine.document import parse_machine
from estimator.rotor.condensation import condense
from estimator.rotor.parameter_names import parameter_units
from service.commands.openapi import text
from tests.plant import document
said = document()
said["bearings"][0]["speed_dependence"] = {"form": "softening", "halving": 300.0}
machine = parse_machine(said)
models = train_models(condense(machine, speed=np.ones(1), direction=np.ones(1)))
(found,) = [one.model for one in models if one.model.coefficients == ("bearing.B1.kxx",)]
assert np.allclose(found.at(np.array([0.0, 300.0])).values(np.zeros(1))[:, 0] / 2e6, [1.0, 0.5])
assert parameter_units(machine)["bearing.B1.kxx"] == "N/m"
assert '"Softening"' in text()
"""


def train_model(copy: Copy) -> str:
    """Add the form "shared_rubber", one model of all bearings; return what has to work with it."""
    copy.write(
        "estimator/bearings/shared_rubber.py",
        '''"""Coefficients of bearings on rubber of one batch: the stiffness of each, one loss factor of all."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, Literal

import numpy as np

from estimator.arrays import Floats
from estimator.bearings.defaults import FormDefaults, NeverLevel
from estimator.bearings.model import CoefficientModel, ModelParameter, OwnParameter, WholeTrain
from estimator.bearings.terms import TERMS
from estimator.field_types import Part

LOSS = 0.2


@dataclass(frozen=True)
class SharedRubberCurves:
    """All coefficients at some speeds: k, then c = loss * k / speed, of each bearing."""

    speed: Floats
    parameters: tuple[ModelParameter, ...]

    def values(self, fitted: Floats) -> Floats:
        columns = []
        for one, own in zip(self.parameters, fitted, strict=True):
            k, c = np.full(self.speed.size, one.value(own)), LOSS * one.value(own) / self.speed
            columns += [k, 0.0 * k, 0.0 * k, k, c, 0.0 * k, 0.0 * k, c]
        return np.stack(columns, axis=1)

    def derivatives(self, fitted: Floats, block: slice) -> Floats:
        found = np.zeros((self.speed[block].size, 8 * fitted.size, fitted.size))
        values = self.values(fitted)[block]
        for one in range(fitted.size):
            found[:, 8 * one : 8 * one + 8, one] = values[:, 8 * one : 8 * one + 8]
        return found


@dataclass(frozen=True)
class SharedRubberModel(NeverLevel):
    """Rubber of all bearings."""

    bearings: tuple[str, ...]
    constant: bool = False
    law = "rubber"

    @property
    def coefficients(self) -> tuple[str, ...]:
        terms = ("kxx", "kxy", "kyx", "kyy", "cxx", "cxy", "cyx", "cyy")
        return tuple(f"bearing.{one}.{term}" for one in self.bearings for term in terms)

    @property
    def parameters(self) -> tuple[ModelParameter, ...]:
        named = (f"bearing.{one}.rubber" for one in self.bearings)
        return tuple(ModelParameter(name, "stiffness", "N/m", True, 2e6, 2e6, 1.0) for name in named)

    def at(self, speed: Floats) -> SharedRubberCurves:
        return SharedRubberCurves(speed, self.parameters)


def shared_rubber(machine: Any) -> SharedRubberModel:
    return SharedRubberModel(tuple(one.id for one in machine.bearings))


class SharedRubber(FormDefaults, Part):
    """Coefficients of rubber of one batch."""

    own_parameters: ClassVar[tuple[OwnParameter, ...]] = (OwnParameter("rubber", "stiffness", "N/m", positive=True),)
    whole_train: ClassVar[WholeTrain | None] = WholeTrain(
        "estimator.bearings.shared_rubber:shared_rubber", of="rubber", reason="its loss is that of one batch"
    )
    form: Literal["shared_rubber"]
    coefficients: tuple[str, ...] | None = None

    def governs(self, term: str) -> bool:
        return term in TERMS

    def parameter_count(self, terms: Sequence[str]) -> int:
        return 1

    def models(self, coefficients: Sequence[ModelParameter]) -> Sequence[CoefficientModel]:
        return ()
''',
    )
    copy.insert("estimator/bearings/registry.py", "FORMS = (", "SharedRubber, ")
    copy.insert(
        "estimator/bearings/registry.py",
        "from estimator.bearings.model import BearingForm, OwnParameter\n",
        "from estimator.bearings.shared_rubber import SharedRubber\n",
    )
    return """
import numpy as np
import pytest
from estimator.fit.identify import identify
from estimator.fit.problem.train_models import train_models
from estimator.machine.document import DocumentError, parse_machine
from estimator.phasors.measurement import Measurement
from estimator.rotor.condensation import condense
from estimator.rotor.parameter_names import parameter_units
from estimator.rotor.response import response
from service.commands.openapi import text
from tests.plant import document
said = document()
for one in said["bearings"]:
    one["speed_dependence"] = {"form": "shared_rubber"}
machine = parse_machine(said)
train = condense(machine, speed=2 * np.pi * np.linspace(8.0, 45.0, 120), direction=np.ones(120))
(found,) = [one for one in train_models(train) if getattr(one.model, "law", "") == "rubber"]
truth = [2.2e6, 1.8e6, 2.5e6, 1.5e6]
values = np.tile([one.expected for one in train.unknowns.coefficients], (120, 1))
values[:, found.coefficients] = found.model.at(train.speed).values(np.log(np.array(truth) / 2e6))
unbalances = np.array([one.nominal for one in train.unknowns.excitations])
clean = response(train, coefficients=values, excitations=unbalances)
noise = np.random.default_rng(1).standard_normal((2, *clean.shape))
phasor = clean + 1e-7 * (noise[0] + 1j * noise[1])
fit = identify(machine, Measurement.of(speed=train.speed, phasor=phasor))
rubber = [one for one in fit.estimates if one.name.endswith(".rubber")]
assert [one.name for one in rubber] == [f"bearing.B{n}.rubber" for n in (1, 2, 3, 4)]
assert all(abs(one.value - value) < 4 * one.standard_error < 2 * value for one, value in zip(rubber, truth)), rubber
assert parameter_units(machine)["bearing.B3.rubber"] == "N/m"
del said["bearings"][2]["speed_dependence"]
with pytest.raises(DocumentError, match="needs the form 'shared_rubber', as the other bearings: its loss"):
    parse_machine(said)
assert '"SharedRubber"' in text()
"""


def resource(copy: Copy) -> str:
    """Add the resource "remarks" with its table; return what has to work with it."""
    versions = sorted((copy.folder / "storage/migrations/versions").glob("[0-9]*.py"))
    (revision,) = re.findall(r'^revision = "(.*)"', versions[-1].read_text(), re.MULTILINE)
    copy.append(
        "storage/tables/machines.py",
        '''

class RemarkRow(Base):
    """A remark."""

    __tablename__ = "remarks"

    id: Mapped[int] = mapped_column(RowKey, primary_key=True)
    machine_id: Mapped[str] = mapped_column(ForeignKey("machines.id"))
    text: Mapped[str] = mapped_column(Text)
''',
    )
    copy.write(
        "storage/migrations/versions/9999_remarks.py",
        f'''"""remarks"""

import sqlalchemy as sa
from alembic import op

revision = "9999"
down_revision = "{revision}"
branch_labels = None
depends_on = None


def upgrade() -> None:
    op.create_table(
        "remarks",
        sa.Column("id", sa.BigInteger().with_variant(sa.Integer(), "sqlite"), primary_key=True),
        sa.Column("machine_id", sa.String(64), sa.ForeignKey("machines.id"), nullable=False),
        sa.Column("text", sa.Text(), nullable=False),
    )


def downgrade() -> None:
    op.drop_table("remarks")
''',
    )
    copy.write(
        "storage/machines/remarks.py",
        '''"""Repository of remarks."""

from sqlalchemy import select
from sqlalchemy.orm import Session

from estimator.errors import Missing
from storage.tables.machines import RemarkRow


class RemarkUnknown(Missing):
    """Raised when there is no remark of a number."""

    subject = "remark"


def add(session: Session, machine_id: str, text: str) -> None:
    session.add(RemarkRow(machine_id=machine_id, text=text))


def get(session: Session, machine_id: str, remark_id: int) -> str:
    row = session.get(RemarkRow, remark_id)
    if row is None or row.machine_id != machine_id:
        raise RemarkUnknown(str(remark_id))
    return row.text


def texts(session: Session, machine_id: str) -> list[str]:
    return list(session.scalars(select(RemarkRow.text).where(RemarkRow.machine_id == machine_id)))
''',
    )
    copy.write(
        "service/api/machines/remarks.py",
        '''"""Serves remarks."""

from fastapi import APIRouter, Request
from pydantic import BaseModel

from service.api.conventions.dependencies import MachineId, Number, Reading, database
from service.api.conventions.problems import RESPONSES
from service.security.requirement import ANALYST, VIEWER
from storage.machines import machines, remarks

router = APIRouter(prefix="/machines/{machine_id}/remarks", responses=RESPONSES, dependencies=[VIEWER])


class Remark(BaseModel):
    text: str


@router.get("", operation_id="list_remarks")
def list_remarks(session: Reading, machine_id: MachineId) -> list[Remark]:
    machines.get(session, machine_id)
    return [Remark(text=one) for one in remarks.texts(session, machine_id)]


@router.get("/{remark_id}", operation_id="get_remark")
def get_remark(session: Reading, machine_id: MachineId, remark_id: Number) -> Remark:
    return Remark(text=remarks.get(session, machine_id, remark_id))


@router.post("", operation_id="add_remark", status_code=201, dependencies=[ANALYST])
def add_remark(request: Request, machine_id: MachineId, said: Remark) -> Remark:
    with database(request).transaction() as session:
        remarks.add(session, machine_id, said.text)
    return said
''',
    )
    application = "service/api/application.py"
    copy.insert(application, "    for part in (\n", "        remarks,\n")
    copy.insert(application, "ROWS: ScopedRows = {\n", '    "remark_id": (RemarkRow, "remark"),\n')
    copy.insert(application, "import BalancingRow, MachineRow, ModelCalibrationRow", ", RemarkRow")
    copy.insert(application, "LISTED: Mapping[str, str] = {\n", '    "remark": f": {OF_MACHINE}/remarks lists them",\n')
    copy.insert(application, "from service.api.alerts.routes import router as alerts\n", f"{REMARKS}\n")
    return """
from service.commands.openapi import text
from storage.database.engine import Database
from storage.machines import machines
from tests.api_in_process import Api
from tests.plant import machine
database = Database("sqlite:///remarks.db")
with database.transaction() as session:
    machines.create(session, machine())
api = Api(database)
api("POST", "/machines/pump-7/remarks", 201, json={"text": "oil changed"})
assert api.value("/machines/pump-7/remarks") == [{"text": "oil changed"}]
assert api.get("/machines/none/remarks").status_code == 404
assert api.value("/machines/pump-7/remarks/1") == {"text": "oil changed"}
unknown = api.get("/machines/pump-7/remarks/2")
assert (unknown.status_code, unknown.json()["detail"]) == (
    404, "no remark 2: GET /api/v1/machines/<id>/remarks lists them"
)
assert "list_remarks" in text()
"""


REMARKS = "from service.api.machines.remarks import router as remarks"


ADDITIONS: dict[str, Callable[[Copy], str]] = {
    "finding": finding,
    "channel": channel,
    "bearing model": bearing_model,
    "model of all bearings": train_model,
    "resource": resource,
}
"""Functions that add each to a copy, and return a script that fails where it does not work."""


@pytest.mark.parametrize(("what", "add"), ADDITIONS.items())
def test_one_more_takes_few_files_and_works(copy: Copy, what: str, add: Callable[[Copy], str]) -> None:
    script = add(copy)
    assert len(copy.touched) <= BOUNDS[what], copy.touched
    place = f"import estimator, service, storage\nassert estimator.__file__.startswith({str(copy.folder)!r})\n"
    copy.run("-c", place + script + DECLARATIONS + copy.bring(CHECKS.get(what, ())))


@pytest.mark.parametrize(
    ("add", "file", "said", "missing"),
    [
        (
            finding,
            "service/monitoring/rules/rotor_findings.py",
            '{"de": "Anstreifen"}',
            "name of finding 'rub' is missing in: de",
        ),
        (
            channel,
            "service/delivery/logbook.py",
            ', "de": "Betriebsbuch"',
            "title of channel kind 'logbook' is missing in: de",
        ),
    ],
)
def test_one_that_a_language_lacks_does_not_start(
    copy: Copy, add: Callable[[Copy], str], file: str, said: str, missing: str
) -> None:
    script = add(copy)
    path = copy.folder / file
    content = path.read_text()
    assert content.count(said) == 1
    path.write_text(content.replace(said, "{}" if said.startswith("{") else ""))
    with pytest.raises(AssertionError, match=missing):
        copy.run("-c", script)
