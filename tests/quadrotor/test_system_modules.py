"""The parts of the quadrotor: their ports are the interface, and what flies reads them all."""

from collections.abc import Callable
from typing import Any

import pytest
import torch
from faultpath_quadrotor.estimators.protocol import ExactEstimator
from faultpath_quadrotor.planners import NavigationCost
from faultpath_quadrotor.plant.module import VehiclePlant
from faultpath_quadrotor.predictors import PredictorInputs, module
from faultpath_quadrotor.vehicle import GRAVITY_MPS2
from flights import HELD_OUT, STEPS, fly, quadrotor
from torch import Tensor

from faultpath.loop import Batch, readers
from faultpath.run.attempt import taps_of
from faultpath.run.check.reads import ReadLog
from faultpath.run.plan import Treatment

LEARNED = {"predictor": "wm-a-wind", "clearance": "depth", "wind": "L2"}
FLOWN = [
    *((LEARNED, variant) for variant in ("zero-wind", "gru", "wm-a", "wm-u", "dki-drag/gru+dcc")),
    ({}, "dob"),
    ({"predictor": "true-parameter"}, "true-wind"),
]
pytestmark = pytest.mark.usefixtures("short")


@pytest.mark.parametrize("clearance", ["true", "depth"])
def test_a_variants_readers_follow_from_its_ports_and_truth_has_one_door(clearance):
    system = quadrotor(clearance=clearance)
    for name, variant in system.variants.items():
        graph = system.loop(name, None).graph
        assert variant.readers == readers(graph.parts)
        assert [type(module) for module in graph.modules if module.truths] == [ExactEstimator]


@pytest.mark.parametrize(("options", "variant"), FLOWN, ids=[name for _, name in FLOWN])
def test_what_flies_reads_every_port_and_commands_late(options, variant):
    system = quadrotor(**options)
    batch = Batch(HELD_OUT[:2], 0, system.control_dt_s)
    log = ReadLog(batch.scenes)
    taps = taps_of(system, Treatment(variant=variant), batch.scenes, observer=log)
    with torch.inference_mode():
        instants = list(system.loop(variant, 0).execute(batch, taps))
    assert (len(instants), instants[-1].step) == (STEPS + 1, STEPS)
    reads = log.reads()
    assert {each.reader for each in reads} == set(system.variants[variant].readers)
    assert all(tap.deliveries == STEPS for tap in taps.delivery_log().taps)
    assert (system.variants[variant].privileged == set()) == (options is LEARNED)
    taught = {each.reader for each in reads if each.channel == "action"}
    late = {each.reader for each in reads if each.valid_step < each.step}
    assert late == taught - {"vehicle.actuators"}


def test_the_mass_has_seven_forms_from_scene_to_cost(monkeypatch):
    """That of the scene, and those below: axes are turned where plant and modules meet taps."""
    system, scenes = quadrotor(), HELD_OUT[:3]
    vehicles = [system.scene(scene).vehicle for scene in scenes]
    forms: dict[str, Tensor] = {}

    def spy(owner: Any, name: str, seen: Callable[[Any, Any], dict[str, Tensor]]) -> None:
        original = getattr(owner, name)

        def spying(*arguments: Any) -> Any:
            result = original(*arguments)
            forms.update(seen(arguments, result))
            return result

        monkeypatch.setattr(owner, name, spying)

    def sensed(arguments: Any, result: Any) -> dict[str, Tensor]:
        vehicle = arguments[1].world.vehicle
        return {"vehicle": vehicle.mass_kg, "reading": result["vehicle"]["mass"]}

    spy(VehiclePlant, "sense", sensed)
    spy(module.PredictorModule, "compute", lambda given, _: {"lanes": given[1]["mass", "dynamics"]})
    spy(module, "predictor_inputs", lambda _, inputs: {"inputs": inputs["mass", "dynamics"]})
    spy(PredictorInputs, "take", lambda _, inputs: {"chunk": inputs["mass", "dynamics"]})
    spy(NavigationCost, "__call__", lambda given, _: {"hover thrust": given[1].hover})
    fly(system, "dob", scenes)
    double, single = torch.float64, torch.float32
    assert {name: (tuple(form.shape), form.dtype) for name, form in forms.items()} == {
        "vehicle": ((32,), double),
        "reading": ((3,), double),
        "lanes": ((32,), double),
        "inputs": ((32, 1), single),
        "chunk": ((3, 1), single),
        "hover thrust": ((3,), single),
    }
    thrust = forms.pop("hover thrust") / GRAVITY_MPS2
    masses = torch.tensor([vehicle.mass_kg for vehicle in vehicles])
    scales = torch.tensor([vehicle.thrust_scale for vehicle in vehicles])
    torch.testing.assert_close(thrust * scales, masses)
    for form in forms.values():
        torch.testing.assert_close(form.flatten()[:3].float(), masses)
