"""One machine's document, as large as is let in, keeps nobody waiting: neither when its run closes nor after a start."""

from pathlib import Path

import numpy as np

from benchmarks.faults.large_documents import largest, train
from benchmarks.faults.worst_documents import closed, send_all
from tests.end_to_end.alive import probing
from tests.end_to_end.processes import Service, until

KINDS = ("sections", "unsure probes", "all at once")
LONGEST_S = 2.0
"""No answer of `/alive` may take longer here, beside other tests; `benchmarks.faults.worst_documents` asks for much less."""


def test_the_worst_documents_that_are_let_in_keep_nobody_waiting(tmp_path: Path) -> None:
    documents = [largest(kind) | {"id": f"m{number}"} for number, kind in enumerate(KINDS)]
    service = Service(tmp_path)
    url = f"http://127.0.0.1:{service.port}/api/v1"
    with service.running() as process:
        assert service.client.post("/machines", json=train(shafts=20, sections=4000)).status_code == 422
        for document in documents:
            assert service.client.post("/machines", json=document).status_code == 201
        sent = send_all(url, documents, seed=0, pace_s=0.05, batches=slice(None, 12))
        process.kill()
        process.wait()
    # The runs are open still: the silence of their machines ends them, where the service hung before.
    with service.running(), probing(url) as took:
        sent += send_all(url, documents, seed=0, pace_s=0.05, batches=slice(12, None))
        until(lambda: closed(service) >= len(documents), within_s=30, what="all runs are closed")
        assert sum(row["received"] for row in service.get("/sources")) == sent == 220 * len(documents)
    service.client.close()
    assert np.max(took) < LONGEST_S
    assert len(took) >= 5  # asked twenty times a second for half a second at least
