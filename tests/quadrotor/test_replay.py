"""A recorded window tells a model what the flight told it, and a fit sees the same, to the bit."""

import pytest
import torch
from faultpath_paper.evidence.inputs import Subject
from faultpath_paper.evidence.playback import at_present
from faultpath_quadrotor.models import predictor, reconstruction
from faultpath_quadrotor.predictors import KinematicIntegrator, PredictorInputs
from faultpath_quadrotor.predictors import module as prediction
from faultpath_quadrotor.state import State
from faultpath_quadrotor.system import Quadrotor
from faultpath_quadrotor.training import windows as replay
from faultpath_quadrotor.training.flight import fly
from faultpath_quadrotor.training.reconstruction_task import _calibration, _history
from faultpath_quadrotor.training.trajectories import record_flights
from faultpath_quadrotor.training.windows import HISTORY, Windows, cut, places
from flights import in_memory


def assert_same(here: PredictorInputs, row: int, there: PredictorInputs, beside: int) -> None:
    one, other = (dict(inputs.delivered) | vars(inputs.state) for inputs in (here, there))
    assert set(one) == set(other)
    assert len(one) > 6
    for name, value in one.items():
        assert torch.equal(value[..., row, 0], other[name][..., beside, 0]), name


@pytest.fixture
def told(monkeypatch) -> list[PredictorInputs]:
    """All that predictors are told, by the module of the loop and by fits alike."""
    seen: list[PredictorInputs] = []
    for module in (prediction, replay):

        def spy(reads, take, original=module.predictor_inputs):
            seen.append(original(reads, take))
            return seen[-1]

        monkeypatch.setattr(module, "predictor_inputs", spy)
    return seen


@pytest.fixture(scope="module")
def windows() -> Windows:
    """As many windows of collected flights as fill whole vectors."""
    return cut(in_memory(fly("wind", range(16), 0))).take(torch.arange(32))


@pytest.mark.parametrize("variant", ["wm-a-wind/gru", "wm-u", "true-parameter/true-wind"])
def test_a_window_tells_the_predictor_what_the_flight_did(variant, told):
    system = Quadrotor.parse(wind="L3", environment="free-space", clearance="true")
    scene = system.library("selection").scenes[0].id
    pool = in_memory(record_flights(system, variant, (scene,), 0))
    flown = tuple(told)
    told.clear()
    windows, presents = cut(pool, stride=2), places(pool, stride=2)[:, 2] + HISTORY
    with torch.inference_mode():
        Subject.load(system, variant, 0).at_present(windows, (), "recording")
    assert len(told) == HISTORY + 1
    assert len(windows) > 3
    for row, present in enumerate(presents.tolist()):
        assert_same(told[-1], row, flown[present], 0)


@pytest.mark.parametrize("name", ["wm-a", "wm-u+dcc", "wm-a-wind", "true-parameter", "dki-drag"])
def test_a_fit_rolls_out_what_the_modules_do(name, windows, told):
    model = predictor(name, 0)
    with torch.inference_mode():
        present = at_present(windows, model, None, {"wind": "true_wind"})
        played, inputs = present.positions(), told[-1]
        fitted = list(replay.predict(model, windows, replay.correct(model, windows)))
    assert inputs is not told[-1]
    for row in range(len(windows)):
        assert_same(told[-1], row, inputs, row)
    assert torch.equal(torch.stack([state.position[..., 0] for state in fitted], -1), played)


@pytest.mark.parametrize("name", ["gru", "gru-withheld"])
def test_a_fit_gives_a_reconstruction_the_history_that_it_remembers(name, windows):
    model = reconstruction(name, 0)
    nobodys = KinematicIntegrator(wind=True, drag_kgps=(0.0, 0.0, 0.0))  # it only reads the wind
    with torch.inference_mode():
        played = at_present(windows, nobodys, model, {"wind": "reconstructed_wind"}).wind()
        supplied = _calibration(windows) if model.network.calibrated else None
        assert torch.equal(model.network.estimate(*_history(windows), supplied), played)


def test_a_vehicle_that_goes_on_as_before_its_flight_keeps_its_estimate():
    """The intervals before the flight are those of the hover that was executed then."""
    hover = State.hover(torch.zeros(3, 32).double(), torch.linspace(0, 3, 32).double())
    values = {
        "position": hover.position,
        "velocity": hover.velocity + 1.0,
        "attitude": hover.rotation,
        "body_rate": hover.rate + 0.1,
        "action": torch.tensor([9.0, 0.1, 0.2, 0.3]).double()[:, None].expand(4, 32),
    }
    reading = {(channel, "history"): value for channel, value in values.items()}
    reading |= {(channel, "head"): torch.ones(32).double() for channel in ("mass", "thrust_scale")}
    module = reconstruction("gru", 0)
    memory = module.begin(reading)
    first = module.wind(memory)
    for _ in range(4):
        memory = module.update(memory, reading)
        assert torch.equal(module.wind(memory), first)
