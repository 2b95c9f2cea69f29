"""Renders machines and their revisions as answers of the API."""

from typing import Any

from estimator.machine.checks.document_warnings import document_warnings
from service.api.machines import schemas
from storage.clock import to_datetime
from storage.machines import machines
from storage.machines.fleet import ListedMachine
from storage.tables.machines import RevisionRow


def listed_machine(one: ListedMachine) -> dict[str, Any]:
    """Return the fields of `MachineSummary`, for lists that are encoded without a model."""
    return {
        "id": one.id,
        "plant": one.plant,
        "name": one.name,
        "revision": one.revision,
        "created_at": to_datetime(one.created_at),
    }


def revision(row: RevisionRow) -> schemas.MachineRevision:
    """Return a revision of a machine's document as the API shows it."""
    document = machines.parsed(row)
    return schemas.MachineRevision(
        id=row.machine_id,
        revision=row.revision,
        created_at=to_datetime(row.created_at),
        document=document,
        warnings=[str(one) for one in document_warnings(document)],
    )
