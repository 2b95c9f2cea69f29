"""Steps of a fit in a valley that residuals bend: they do not swing from side to side."""

from estimator.fit.identification import Options
from estimator.fit.identify import identify
from estimator.machine.document import parse_machine
from tests.film_plant.discrepancy import DiscrepancySize
from tests.film_plant.documents import film_document, measured
from tests.film_plant.plants import motor_compressor_plant


def test_a_fit_from_the_last_one_s_end_takes_few_steps_on_films() -> None:
    plant = motor_compressor_plant(0, "flexible", discrepancy=DiscrepancySize())
    machine, options = parse_machine(film_document(plant)), Options(starts=3)
    last = identify(machine, measured(plant, seed=0), options)
    found = identify(machine, measured(plant, seed=100_000), options, beginning=last.point)
    assert found.accepted, found.verdict
    assert found.iterations <= 10  # 28 where whole steps were taken
