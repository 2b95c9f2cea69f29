"""Adds the resource "remarks" of a machine, with its table."""

import re

from tests.additions.addition import Addition
from tests.additions.package_copy import PackageCopy

MIGRATION = '''"""remarks"""

import sqlalchemy as sa
from alembic import op

revision = "9999"
down_revision = "<LAST>"
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
'''

REPOSITORY = '''"""Repository of remarks."""

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
'''

ROUTES = '''"""Serves remarks."""

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
'''

ROW = '''

class RemarkRow(Base):
    """A remark."""

    __tablename__ = "remarks"

    id: Mapped[int] = mapped_column(RowKey, primary_key=True)
    machine_id: Mapped[str] = mapped_column(ForeignKey("machines.id"))
    text: Mapped[str] = mapped_column(Text)
'''

IMPORT = "from service.api.machines.remarks import router as remarks\n"

CHECK = """
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
assert "list_remarks" in OPENAPI
"""


def _add(copy: PackageCopy) -> None:
    versions = sorted((copy.folder / "storage/migrations/versions").glob("[0-9]*.py"))
    (last,) = re.findall(r'^revision = "(.*)"', versions[-1].read_text(), re.MULTILINE)
    copy.append("storage/tables/machines.py", ROW)
    copy.write("storage/migrations/versions/9999_remarks.py", MIGRATION.replace("<LAST>", last))
    copy.write("storage/machines/remarks.py", REPOSITORY)
    copy.write("service/api/machines/remarks.py", ROUTES)
    application = "service/api/application.py"
    copy.insert(application, "    for part in (\n", "        remarks,\n")
    copy.insert(application, "ROWS: ScopedRows = {\n", '    "remark_id": (RemarkRow, "remark"),\n')
    copy.insert(application, "import BalancingRow, MachineRow, ModelCalibrationRow", ", RemarkRow")
    copy.insert(application, "LISTED: Mapping[str, str] = {\n", '    "remark": f": {OF_MACHINE}/remarks lists them",\n')
    copy.insert(application, "from service.api.alerts.routes import router as alerts\n", IMPORT)


RESOURCE = Addition("resource", most_files=5, add=_add, check=CHECK, tests=("tests/service/http/test_error_categories.py",))
