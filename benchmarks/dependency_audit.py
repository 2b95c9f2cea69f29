"""Known vulnerabilities of what is installed here: `make audit`. Advisories come from the network, by way of pip-audit.

Ends with status 1 when one is found. Where the advisories cannot be had it says so and ends with status 0: that is not the
same as none being found, and the last line tells the two apart.
"""

import json
import subprocess
import sys
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

TIMEOUT_S = 300.0
OWN = "rotorundown"
"""The project's own package, which no index holds."""


@dataclass(frozen=True)
class Judged:
    """The result of an audit. looked_up: packages covered by advisories; others: those that are not."""

    found: list[str] = field(default_factory=list)
    looked_up: int = 0
    others: list[str] = field(default_factory=list)

    @property
    def words(self) -> str:
        """Return the result as text."""
        if self.found:
            return "\n".join(["VULNERABLE:", *self.found])
        if not self.looked_up:
            return "NOT AUDITED: the advisory service does not answer for any package; ask again where it can be reached"
        rest = f"; not known there: {', '.join(self.others)}" if self.others else ""
        return f"no known vulnerability in {self.looked_up} packages{rest}"


def judged(report: Mapping[str, Any]) -> Judged:
    """Return the result in a report of pip-audit."""
    found, looked_up, others = [], 0, []
    for one in report["dependencies"]:
        if "skip_reason" in one:
            others += [one["name"]] if one["name"] != OWN else []
            continue
        looked_up += 1
        for each in one["vulns"]:
            fixed = ", ".join(each.get("fix_versions", [])) or "no release yet"
            found.append(f"{one['name']} {one['version']}: {each['id']}, fixed in {fixed}")
    return Judged(found, looked_up, others)


def main() -> int:
    """Ask, and say what came of it."""
    command = [
        sys.executable,
        "-m",
        "pip_audit",
        "--local",
        "--format",
        "json",
        "--progress-spinner",
        "off",
        "--timeout",
        "10",
    ]
    try:
        ran = subprocess.run(command, capture_output=True, text=True, timeout=TIMEOUT_S, check=False)
        outcome = judged(json.loads(ran.stdout))
    except (subprocess.TimeoutExpired, ValueError, KeyError) as error:
        reason = (ran.stderr.strip().splitlines() or [str(error)])[-1] if isinstance(error, ValueError) else str(error)
        print(f"pip-audit gave no report: {reason}")
        outcome = Judged()
    print(outcome.words)
    return 1 if outcome.found else 0


if __name__ == "__main__":
    sys.exit(main())
