"""Every machine, its open alerts, and how far its couplings' stiffness went since the first run: python overview.py [URL]"""

import sys

from service.client import Rundown


def main() -> None:
    """Print the overview of all machines."""
    with Rundown(*sys.argv[1:2]) as rundown:
        for machine in rundown.fleet():
            last = machine.last_identification
            measured = "no run yet" if last is None else f"{last.measured_at:%Y-%m-%d %H:%M} UTC: {last.verdict}"
            print(f"{machine.id}: {machine.state}; {measured}")
            for alert in rundown.alerts(machine=machine.id, only_open=True):
                print(f"  {alert.severity}: {alert.message}")
            couplings = rundown.machine(machine.id).document.couplings
            if couplings:
                trends = rundown.trends(machine.id, *(f"coupling.{one.id}.kxx" for one in couplings))
                for series in trends.series:
                    points = zip(series.value, series.quality, strict=True)
                    good = [value for value, quality in points if value is not None and quality == "accepted"]
                    if good:
                        change = 100 * (good[-1] / good[0] - 1)
                        print(f"  {series.parameter}: {good[-1]:.3g} {series.unit}, {change:+.1f} % in {len(good)} runs")


if __name__ == "__main__":
    main()
