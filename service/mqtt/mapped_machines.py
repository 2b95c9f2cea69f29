"""The machines whose documents in force say how their metrics are named in Sparkplug B."""

from estimator.machine.document import Machine
from storage.database.engine import Database
from storage.machines import machines


class MappedMachines:
    """The machines, read again where a document was revised. For one thread."""

    def __init__(self, database: Database) -> None:
        self._database = database
        self._known: dict[str, tuple[int, Machine | None]] = {}

    def read(self) -> list[Machine]:
        """Return the machines by id."""
        with self._database.reading() as session:
            rows = {row.id: row.revision for row in machines.list_all(session)}
            for name, revision in rows.items():
                if self._known.get(name, (0, None))[0] != revision:
                    document = machines.document(session, name, revision)
                    self._known[name] = revision, document if document.sparkplug is not None else None
        return [one for name in sorted(rows) if (one := self._known[name][1]) is not None]
