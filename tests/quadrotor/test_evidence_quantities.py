"""The quantities on recorded windows: what must hold whatever the models are."""

import numpy as np
import pytest
import torch
from faultpath_paper.evidence.inputs import with_shuffled_history
from faultpath_paper.evidence.quantities import STRIDE, RecordedWindows, measured
from faultpath_paper.evidence.table import Measurement, Recording
from faultpath_quadrotor.platform import PLATFORM
from faultpath_quadrotor.training.flight import fly
from faultpath_quadrotor.training.windows import HISTORY, cut, places
from flights import in_memory

from faultpath.core.errors import UserError

RECORDING = Recording(library="selection", variant="true-parameter", options={"wind": "L3"})
SHARED = "calibration=+0.1"
QUANTITIES = ("acceleration", "wind-term")
AT_RECONSTRUCTION, AT_PREDICTOR = f"{SHARED}@reconstruction", f"{SHARED}@predictor"


@pytest.fixture(scope="module")
def recorded() -> RecordedWindows:
    """Windows of four windy collection flights in place of closed-loop ones."""
    flown = in_memory(fly("wind", range(4), 0))
    place = places(flown, STRIDE)
    scenes = tuple(f"scene/{episode}" for episode in place[:, 0])
    return RecordedWindows(cut(flown, STRIDE), scenes, place[:, 2] + HISTORY)


def ask(recorded, quantity, subject, *faults) -> np.ndarray:
    named = {"quantity": quantity, "subject": subject, "seed": 0, "faults": faults}
    found = measured(Measurement(recording=RECORDING, **named), recorded)
    assert (found.scenes, len(found)) == (recorded.scenes, len(recorded.windows))
    assert np.isfinite(found.values).all()
    return found.values


def test_an_identity_fault_gives_exactly_no_response_and_changes_no_error(recorded):
    for fault in ("calibration=0", "history_code:scale=1"):
        assert not ask(recorded, "position-response", "wm-a", fault).any()
    assert not ask(recorded, "position-response", "wm-a-wind/gru", "wind:scale=1").any()
    plain = ask(recorded, "acceleration-error", "gru")
    assert np.array_equal(plain, ask(recorded, "acceleration-error", "gru", "calibration=0"))
    assert np.median(ask(recorded, "shuffle-response", "wm-a")) > 0
    # A constant code hides the history, and then its order too.
    assert not ask(recorded, "shuffle-response", "wm-a", "history_code:scale=0").any()


def test_shuffling_a_history_moves_its_steps_alone_and_each_window_s_by_its_own_draw(recorded):
    windows = recorded.windows
    shuffled = with_shuffled_history(windows, 0)
    assert torch.equal(shuffled.position[:, HISTORY:], windows.position[:, HISTORY:])
    assert torch.equal(shuffled.command[:, HISTORY:], windows.command[:, HISTORY:])
    orders: set[tuple[int, ...]] = set()
    for w in range(5):
        steps = windows.velocity[:, :HISTORY, w].T.tolist()
        order = tuple(steps.index(step) for step in shuffled.velocity[:, :HISTORY, w].T.tolist())
        assert sorted(order) == list(range(HISTORY))
        for name in ("rotation", "command"):
            one, two = (getattr(each, name)[..., :HISTORY, w] for each in (windows, shuffled))
            assert torch.equal(two, one[..., list(order)])
        orders.add(order)
    assert len(orders) == 5
    again = with_shuffled_history(windows.take(torch.tensor([3])), 0)
    assert torch.equal(again.rate[..., 0], shuffled.rate[..., 3])
    other = with_shuffled_history(windows, 1)
    assert not torch.equal(other.rate, shuffled.rate)


def test_the_wind_input_is_the_variant_s(recorded):
    subjects = (f"true-parameter/{wind}" for wind in ("true-wind", "gru", "zero-wind"))
    right, estimated, none = (np.median(ask(recorded, "position-error", s)) for s in subjects)
    assert right < estimated < none


def test_a_fault_strikes_only_the_readers_that_it_names(recorded):
    clean, at_reconstruction, at_predictor, shared = (
        ask(recorded, "position-response", "wm-a-wind/gru", *faults)
        for faults in ((), (AT_RECONSTRUCTION,), (AT_PREDICTOR,), (SHARED,))
    )
    assert not clean.any()
    assert min(at_reconstruction.min(), at_predictor.min()) > 0
    assert np.median(shared) < np.median(at_reconstruction)
    assert not ask(recorded, "position-response", "gru-withheld", "mass:scale=1").any()
    without = ask(recorded, "position-error", "wm-a-wind/gru-withheld", AT_PREDICTOR)
    assert np.array_equal(without, ask(recorded, "position-error", "gru-withheld", SHARED))


def test_with_a_correct_predictor_the_wind_term_is_the_whole_acceleration_error(recorded):
    def apart(*faults):
        whole, wind = (ask(recorded, f"{of}-error", "gru", *faults) for of in QUANTITIES)
        return np.abs(whole - wind)

    assert not apart().any()
    assert not apart(AT_RECONSTRUCTION).any()
    assert np.median(apart(SHARED)) > 0.1


def test_true_wind_and_correct_calibration_leave_no_acceleration_error(recorded):
    assert not ask(recorded, "acceleration-error", "true-wind").any()
    windows, drag = recorded.windows, torch.tensor(PLATFORM.drag_kgps, dtype=torch.float64)
    to_world = windows.rotation[:, :, HISTORY].double()
    along_body = torch.einsum("wbn,wn->bn", to_world, windows.wind_mps[:, HISTORY].double())
    force = (drag[:, None] * along_body).norm(dim=0).numpy()
    still = ask(recorded, "wind-term-error", "zero-wind")
    np.testing.assert_allclose(still, force / windows.mass_kg.numpy(), rtol=1e-4)


@pytest.mark.parametrize(
    ("quantity", "subject", "fault"),
    [
        ("position-error", "wm-a-wind/gru", SHARED),
        ("position-response", "wm-a+dcc", "mass:noise=0.1,relative"),
        ("shuffle-response", "wm-a+dcc", SHARED),
        ("acceleration-error", "dob", AT_PREDICTOR),
    ],
)
def test_a_window_s_number_does_not_depend_on_those_beside_it(recorded, quantity, subject, fault):
    order = torch.arange(len(recorded.windows)).flip(0)[:37]
    scenes = tuple(recorded.scenes[i] for i in order)
    some = RecordedWindows(recorded.windows.take(order), scenes, recorded.steps[order.numpy()])
    whole = ask(recorded, quantity, subject, fault)
    assert np.array_equal(ask(some, quantity, subject, fault), whole[order.numpy()])


@pytest.mark.parametrize(
    ("fault", "says"),
    [
        ("velocity:noise=1", "do not deliver"),
        ("mass:delay=2", "acts in time"),
        ("mass:scale=2,onset=3", "acts in time"),
        (AT_RECONSTRUCTION, "reaches no reader"),
    ],
)
def test_a_fault_that_windows_cannot_have_is_refused(recorded, fault, says):
    with pytest.raises(UserError, match=says):
        ask(recorded, "position-error", "wm-a", fault)
