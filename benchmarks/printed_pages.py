"""Writes the pages of the evidence that are what benchmarks print.

    python -m benchmarks.printed_pages run-downs
    python -m benchmarks.printed_pages service --section "The REST API"

With `--section` the other sections stay as they were written; each names the commit that it was measured on.
"""

import argparse
from collections.abc import Sequence

from benchmarks.printed_page import PrintedPage, PrintedSection

RUN_DOWNS = PrintedPage(
    "evidence-run-downs.md",
    """\
# The evidence: from readings to runs and phasors

What is done to readings before a fit sees them, on simulated machines and waveforms. Seeds are stated in the code, so that the
same numbers come again; times are those of the machine that ran it.""",
    (
        PrintedSection(
            "States and runs",
            "Simulated cycles of run-up, hold and run-down, with noise of the speed as a keyphasor's, or of a constant size "
            "as soon as the shaft turns.",
            ("benchmarks.estimator.states",),
        ),
        PrintedSection(
            "Picked samples",
            "A run-down of the Chapter 3 train of which samples are picked for the fit, or averaged.",
            ("benchmarks.estimator.capture",),
        ),
        PrintedSection(
            "Phasors from waveforms",
            "Least squares over a block beside band-pass and peak picking as in the thesis (§5.4); 26 dB is noise of 5 %.",
            ("benchmarks.estimator.phasors",),
        ),
        PrintedSection(
            "Wrong conventions",
            "A wrong unit, phase, sense of rotation or pair of probes on a refused run: how often it is named rightly; "
            "and whether any is named on right runs.",
            ("benchmarks.calibration.conventions", "--trials", "1", "--runs", "30"),
        ),
        PrintedSection(
            "The sense of orbits",
            "Run-downs of the examples that have pairs of probes: nothing wrong, each pair swapped in turn, sense reversed.",
            ("benchmarks.estimator.orbit_sense",),
        ),
        PrintedSection(
            "Coast-downs",
            "The Chapter 3 train with half of its damping, integrated in time; waveforms through keyphasor and order "
            "tracking; documents wrong by 10 %.",
            ("benchmarks.estimator.coast_down", "--runs", "6"),
        ),
    ),
)
SERVICE = PrintedPage(
    "evidence-service.md",
    """\
# The evidence: the service under load

What the service does beside real sources, brokers, browsers and databases, all of them on loopback and on the same two cores
of a shared virtual machine, with nothing else to do. A machine of its own for each goes further.""",
    (
        PrintedSection(
            "Samples of sixteen channels, SQLite",
            "From a source with a durable log by way of a router to what another connection sees committed.",
            ("benchmarks.throughput",),
        ),
        PrintedSection(
            "Samples of sixteen channels, PostgreSQL",
            "The same with a PostgreSQL server on the same two cores.",
            ("benchmarks.throughput", "--database", "postgresql"),
        ),
        PrintedSection(
            "From publication to the REST API",
            "A reader asks for the newest samples over and over and notes when it first sees each.",
            ("benchmarks.latency",),
        ),
        PrintedSection(
            "The REST API",
            "Eight clients at once, alone and while samples are stored; each p99 is judged over that of `/alive`.",
            ("benchmarks.api_latency",),
        ),
        PrintedSection(
            "Identifications in an hour",
            "Run-downs of 100 samples of 8 channels, 40 parameters each, beside a thousand samples a second.",
            ("benchmarks.identifications_per_hour",),
        ),
        PrintedSection(
            "The page in a browser",
            "Headless Chromium with an empty cache visits a machine's page.",
            ("benchmarks.page_paint",),
        ),
        PrintedSection(
            "Alerts on their way",
            "To a listener of the event stream and to webhooks, while many receivers hang, fail or are gone.",
            ("benchmarks.delivery",),
        ),
        PrintedSection("A year's report", "Printed as PDF in its worker process, over HTTP.", ("benchmarks.report",)),
        PrintedSection("MQTT", "Mosquitto with TLS and passwords, killed meanwhile.", ("benchmarks.mqtt",)),
        PrintedSection("OPC UA", "A server in a process of its own and the library's client.", ("benchmarks.opcua",)),
        PrintedSection(
            "Without MQTT and OPC UA",
            "Memory of a service in which neither is configured.",
            ("benchmarks.unconfigured_protocols",),
        ),
        PrintedSection("Room of a run", "10,000 samples of 16 channels with noise on every number.", ("benchmarks.disk",)),
    ),
)
FAULTS = PrintedPage(
    "evidence-faults.md",
    """\
# The evidence: faults, rubbish and very many of everything

Real processes on loopback, all on the same two cores of a shared virtual machine, with nothing else to do. What breaks and
what then happens, fault by fault, is in [faults.md](faults.md).""",
    (
        PrintedSection(
            "Parts killed, frozen and cut off",
            "After each scenario the store is compared with what was measured, sample by sample, to the bit.",
            ("benchmarks.faults", "--only", "killed ", "--kills", "20"),
        ),
        PrintedSection(
            "Rubbish",
            "Messages of twelve kinds that no source should send, through decoding and into a store.",
            ("benchmarks.faults.fuzz", "--cases", "200000"),
        ),
        PrintedSection(
            "The store is in the way",
            "Locked, read-only, on a full disk; its server stopped.",
            ("benchmarks.faults", "--only", "store"),
        ),
        PrintedSection(
            "The router starts again",
            "Twenty times while sources measure.",
            ("benchmarks.faults", "--only", "router started"),
        ),
        PrintedSection(
            "Alerts told through kills",
            "Every transition is told once, in order, through twenty kills.",
            ("benchmarks.faults", "--only", "alerts told"),
        ),
        PrintedSection("Ten thousand machines", "Two hundred of them run down at once.", ("benchmarks.faults.many_machines",)),
        PrintedSection(
            "A service that was away",
            "A hundred sources hold in their logs what it has never seen.",
            ("benchmarks.faults.catching_up", "--sources", "100", "--batches", "1000"),
        ),
        PrintedSection(
            "Clients that never read",
            "A thousand listeners of the event stream, a hundred of which never read.",
            ("benchmarks.faults.stream_clients",),
        ),
        PrintedSection(
            "Documents of the worst kinds",
            "Fifty machines whose documents ask for as much as they may run down at once.",
            ("benchmarks.faults.worst_documents",),
        ),
        PrintedSection(
            "Lives of alerts",
            "Random steps with restarts and kills between them, judged against the rules of ISA-18.2.",
            ("benchmarks.faults.alert_life",),
        ),
        PrintedSection(
            "Starting with many machines",
            "A store of ten thousand machines, a hundred of them with five years of weekly identifications.",
            ("benchmarks.cold_start", "--identified", "100"),
        ),
    ),
)
MODEL = PrintedPage(
    "evidence-model.md",
    """\
# The evidence: what follows from a fit

How often intervals of what is derived from identifications hold the truth, on simulated machines. Seeds stand in the code,
so that the same numbers come again; times are those of the machine that ran it.""",
    (
        PrintedSection(
            "Bands of a model's results",
            "The Chapter 3 train, identified from noise drawn again and again.",
            ("benchmarks.estimator.updated_model",),
        ),
        PrintedSection(
            "Quantities of every identification",
            "Drawn machines of three examples, with what computing these quantities costs beside the fit.",
            ("benchmarks.estimator.derived",),
        ),
        PrintedSection(
            "Trends",
            "Probabilities of deviations from baselines of few runs, and the rate of change with the default limits.",
            ("benchmarks.estimator.trend_tests",),
        ),
    ),
)
PAGES = {"run-downs": RUN_DOWNS, "model": MODEL, "service": SERVICE, "faults": FAULTS}


def main(arguments: Sequence[str] | None = None) -> None:
    """Write the pages that are asked for."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.printed_pages", description=(__doc__ or "").split("\n")[0])
    parser.add_argument("pages", nargs="+", choices=PAGES)
    parser.add_argument("--section", action="append", default=[], help="heading of a section that alone is measured anew")
    options = parser.parse_args(arguments)
    headings = {section.heading for name in options.pages for section in PAGES[name].sections}
    if unknown := set(options.section) - headings:
        parser.error(f"no section {', '.join(sorted(unknown))}; there are: {', '.join(sorted(headings))}")
    for name in options.pages:
        print(PAGES[name].write(options.section))


if __name__ == "__main__":
    main()
