"""Documents with thousands of problems, many at a time: refused with words, while others are answered."""

import json
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import httpx

from tests.end_to_end.alive import probing
from tests.end_to_end.processes import Service
from tests.plant import document

AT_ONCE, TIMES = 20, 3


def test_who_sends_many_wrong_documents_keeps_nobody_from_being_answered(tmp_path: Path) -> None:
    wrong = document()
    wrong["shafts"] = [{"id": "A", "sections": [{}] * 200}] * 20
    body = json.dumps(wrong).encode()
    service = Service(tmp_path)

    def refused(_number: int) -> httpx.Response:
        return service.client.post("/machines", content=body, headers={"content-type": "application/json"})

    with service.running(), probing(str(service.client.base_url).rstrip("/")) as took:
        time.sleep(0.2)
        began = time.perf_counter()
        with ThreadPoolExecutor(AT_ONCE) as pool:
            for answer in pool.map(refused, range(AT_ONCE * TIMES)):
                assert answer.status_code == 422, answer.text
                assert "more than 200 problems" in answer.json()["errors"][-1]["message"]
        lasted = time.perf_counter() - began
    service.client.close()
    assert max(took) < lasted / 3
