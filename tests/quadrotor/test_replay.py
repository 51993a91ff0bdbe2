"""A recorded window tells a model what the flight told it, to the bit."""

from dataclasses import fields

import pytest
import torch

from faultpath.quadrotor.evidence.inputs import Subject
from faultpath.quadrotor.modules import prediction
from faultpath.quadrotor.predictors import PredictorInputs
from faultpath.quadrotor.system import Quadrotor
from faultpath.quadrotor.training import replay
from faultpath.quadrotor.training.closed_loop import record_flights
from faultpath.quadrotor.training.pool import FlightData, encode_episodes, encode_rows
from faultpath.quadrotor.training.windows import HISTORY, cut, places

torch.set_num_threads(1)


def parts(inputs: PredictorInputs, row: int) -> dict[str, torch.Tensor]:
    """All that a predictor is told of one vehicle, by name."""
    found = {}
    for field in fields(inputs):
        value = getattr(inputs, field.name)
        if isinstance(value, torch.Tensor):
            found[field.name] = value[..., row, 0]
        elif value is not None:
            found |= {f"{field.name}.{k}": each[..., row, 0] for k, each in vars(value).items()}
    return found


@pytest.mark.parametrize("variant", ["wm-a-wind/gru", "wm-u", "true-parameter/true-wind"])
def test_a_window_tells_the_predictor_what_the_flight_did(variant, monkeypatch):
    flown: list[PredictorInputs] = []
    replayed: list[PredictorInputs] = []
    for module, seen in ((prediction, flown), (replay, replayed)):

        def spy(reads, take, original=module.predictor_inputs, seen=seen):
            seen.append(original(reads, take))
            return seen[-1]

        monkeypatch.setattr(module, "predictor_inputs", spy)
    system = Quadrotor.parse(wind="L3", environment="free-space", clearance="true")
    scene = system.library("selection").scenes[0].id
    flights = record_flights(system, variant, (scene,), 0)
    pool = FlightData.decode(
        "x", encode_rows(range(1), flights), encode_episodes(range(1), flights)
    )
    windows, presents = cut(pool, stride=2), places(pool, stride=2)[:, 2] + HISTORY
    subject = Subject.load(system, variant, 0)
    with torch.inference_mode():
        delivered = subject.deliver(windows, (), "recording")
        replay.predict(subject.predictor, windows, delivered)
    (once,) = replayed
    assert len(windows) > 3
    for row, present in enumerate(presents.tolist()):
        here, there = parts(once, row), parts(flown[present], 0)
        assert set(here) == set(there)
        assert len(here) > 6
        for name, value in here.items():
            assert torch.equal(value, there[name]), (name, present)
