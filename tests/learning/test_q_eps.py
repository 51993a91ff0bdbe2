"""Laws of the errors that a fit draws: magnitude, persistence, dependence, and what the taps do."""

from collections.abc import Sequence
from math import exp

import numpy as np
import pytest
from repair_toys import DT_S, INTERFACE, windows

from faultpath.core.errors import UserError
from faultpath.faults import Fault, resolve
from faultpath.learning import errors, uncertainty_training, withholding
from faultpath.learning.windows import delivered
from faultpath.loop import Port

GAIN, VELOCITY = Port("gain", "model"), Port("velocity", "difference")


def relative_errors(q_eps: Sequence[Fault], n: int = 4000, steps: int = 3, seed: int = 0):
    """What the observer's ports get of readings of one: error by port, `[N, T]`."""
    data = windows(n, steps, readings={"gain": np.ones(n), "velocity": np.ones((n, steps))})
    faults = resolve(q_eps, data.interface, data.readers)
    got, _ = delivered(data, faults, data.readings, range(n), seed, epoch=0)
    return {port: value - 1 for port, value in got.items()}


def correlation(a: np.ndarray, b: np.ndarray) -> float:
    return float(np.corrcoef(a.ravel(), b.ravel())[0, 1])


@pytest.mark.parametrize(
    ("persistence", "lag_one"), [("window", 1.0), ("step", 0.0), (0.5, exp(-DT_S / 0.5))]
)
def test_magnitude_is_the_deviation_and_persistence_how_steps_go_together(persistence, lag_one):
    error = relative_errors(errors({"gain": 0.1}, persistence))[GAIN]
    assert error.std(axis=0) == pytest.approx([0.1] * 3, rel=0.05)
    assert np.abs(error.mean(axis=0)).max() < 0.006
    assert correlation(error[:, 0], error[:, 1]) == pytest.approx(lag_one, abs=0.05)
    assert correlation(error[:, 0], error[:, 2]) == pytest.approx(lag_one**2, abs=0.05)


@pytest.mark.parametrize(
    ("dependence", "expected"),
    [(0.0, 0.0), (0.5, 0.5), (1.0, 1.0), ({"gain": 1.0, "velocity": -1.0}, -1.0)],
)
@pytest.mark.parametrize("persistence", ["window", "step", 0.5])
def test_dependence_is_the_correlation_of_two_channels(persistence, dependence, expected) -> None:
    found = relative_errors(errors({"gain": 0.1, "velocity": 0.3}, persistence, dependence))
    assert found[VELOCITY].std() == pytest.approx(0.3, rel=0.05)
    together = correlation(found[GAIN][:, 2], found[VELOCITY][:, 2])
    assert together == pytest.approx(expected, abs=0.05)


def test_places_of_one_channel_get_the_same_error_and_one_place_may_err_alone() -> None:
    everywhere = errors({"gain": 0.1})
    both = relative_errors(everywhere, 20)
    assert (both[GAIN] == both[Port("gain", "scale")]).all()
    alone = relative_errors([part.aimed_at("observer.scale") for part in everywhere], 20)
    assert not alone[GAIN].any()
    assert (alone[Port("gain", "scale")] == both[GAIN]).all()


def test_draws_belong_to_window_seed_and_epoch_and_not_to_the_minibatch() -> None:
    data = windows(30)
    faults = resolve(errors({"gain": 0.1}, "step"), data.interface, data.readers)

    def of(index, seed=0, epoch=0):
        rows = {name: value[index] for name, value in data.readings.items()}
        return delivered(data, faults, rows, index, seed, epoch)[0][GAIN]

    whole = of(np.arange(30))
    assert (of(np.array([17, 3])) == whole[[17, 3]]).all()
    assert (of(np.arange(30), epoch=1) != whole).all()
    assert (of(np.arange(30), seed=1) != whole).all()


def test_without_a_fault_the_readings_of_an_instant_arrive_as_they_are() -> None:
    data = windows(5, None)
    got, counts = delivered(data, (), data.readings, range(5), 0, 0)
    assert (got[VELOCITY] == data.readings["velocity"]).all()
    assert not any(count.altered_steps for count in counts)


UNEVEN = {"gain": np.ones((60, 4)), "velocity": np.ones((60, 5))}


def of_observer(repair):
    return repair.against(INTERFACE, DT_S, windows().readers)


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (uncertainty_training, "name at least one error"),
        (lambda: errors({}), "names no channel"),
        (lambda: errors({"gain": -0.1}), "must not be negative"),
        (lambda: errors({"gain": 0.1}, "hour"), "'hour' is none"),
        (lambda: errors({"gain": 0.1}, -1.0), "-1.0 is none"),
        (lambda: errors({"gain": 0.1}, dependence=1.5), "not from 0 to 1"),
        (lambda: errors({"gain": 0.1}, dependence={"wind": 1.0}), "name the same channels"),
        (lambda: windows(reader="captain"), "unknown reader 'captain'"),
        (lambda: windows(reader="controller"), "read slope, of which there are no readings"),
        (lambda: windows(targets=np.zeros(7)), "7 rows for 60 windows"),
        (lambda: windows(2, ids=("a", "a")), "same id"),
        (lambda: windows(readings={}), "no readings"),
        (lambda: windows(readings=UNEVEN), "interface says"),
        (lambda: of_observer(uncertainty_training("gain")), "gain"),
        (lambda: of_observer(uncertainty_training("wind:scale=2")), "unknown channel 'wind'"),
        (lambda: of_observer(uncertainty_training("gain:scale=2@controller")), "reaches no reader"),
        (lambda: of_observer(withholding("heading", value=0.0)), r"shape \[3\]"),
        (lambda: of_observer(withholding("gain", "pilot")), "does not read it"),
    ],
)
def test_bad_input_is_one_sentence(make, said) -> None:
    with pytest.raises(UserError, match=said) as caught:
        make()
    assert "\n" not in str(caught.value)
