import pytest

from lab.evaluation.experiment import TEST_SEED, Options
from lab.evaluation.experiments.calibrate import SWEEPS, Sweep, choice, plateau_middle, training
from services.mapper.domain.params import MapParams


def test_the_middle_of_the_plateau_around_the_best_is_chosen() -> None:
    values = (0.8, 0.9, 1.0, 1.1, 1.2, 1.3)
    assert (
        plateau_middle(values, [40.0, 50.0, 50.4, 50.3, 49.95, 30.0]) == 1.0
    )  # 0.9 to 1.2, the first of two
    assert plateau_middle(values, [10.0, 20.0, 30.0, 90.0, 30.0, 20.0]) == 1.1


def test_a_second_peak_apart_from_the_best_does_not_pull_the_choice() -> None:
    assert plateau_middle((1, 2, 3, 4, 5), [50.0, 20.0, 50.2, 50.1, 50.3]) == 4


def test_values_that_are_measured_only_are_never_chosen() -> None:
    scores = [90.0, 80.0, 50.0, 60.0, 59.8]

    assert choice(Sweep("tau", "association", (0.8, 0.9, 1.0, 1.1, 1.2), least=1.0), scores) == 1.1
    assert choice(Sweep("tau", "association", (0.8, 0.9, 1.0, 1.1, 1.2)), scores) == 0.8


@pytest.mark.parametrize("sweep", SWEEPS, ids=lambda sweep: sweep.name)
def test_each_sweep_changes_its_own_setting_and_nothing_else(sweep) -> None:  # type: ignore[no-untyped-def]
    default = MapParams()
    changed = sweep.put(default, sweep.values[-1])
    assert getattr(getattr(changed, sweep.part), sweep.name) == sweep.values[-1]
    assert changed != default
    assert sweep.put(changed, getattr(getattr(default, sweep.part), sweep.name)) == default
    assert list(sweep.values) == sorted(sweep.values)


def test_calibration_never_sees_a_test_home() -> None:
    assert training(Options(homes=6)).seed == 0
    assert training(Options(homes=6, seed=40)).seed == 40
    last = training(Options(homes=50, seed=TEST_SEED - 10))
    assert last.seed + last.homes <= TEST_SEED
