"""RotorPy, untouched: it flies in our loop as in its own, and a fault reaches who reads."""

from itertools import count

import numpy as np
import pytest

pytest.importorskip("rotorpy")

from foreign_trials import ROOT, attempted, faulted, imported
from rotorpy.controllers.quadrotor_control import SE3Control
from rotorpy.estimators.wind_ukf import WindUKF
from rotorpy.sensors.external_mocap import MotionCapture
from rotorpy.sensors.imu import Imu
from rotorpy.simulate import simulate
from rotorpy.trajectories.hover_traj import HoverTraj
from rotorpy.vehicles.hummingbird_params import quad_params
from rotorpy.vehicles.multirotor import Multirotor
from rotorpy.world import World
from scipy.spatial.transform import Rotation

from faultpath import generator
from faultpath.system import shared_objects

SCENE, STEPS = "seed/7", 60


@pytest.fixture(scope="module")
def example():
    """The example, with short flights."""
    with pytest.MonkeyPatch.context() as patch:
        yield imported(patch, "rotorpy_wind.py", STEPS=STEPS)


class FirstExact(MotionCapture):
    """Theirs, but for its first reading, which the example takes without noise."""

    asked = False

    def measurement(self, state, with_noise=False, with_artifacts=False):
        with_noise, self.asked = with_noise and self.asked, True
        return super().measurement(state, with_noise, with_artifacts)


class Seeded(Imu):
    """Theirs, from which on each step draws what it draws in our loop."""

    def __init__(self, rate):
        super().__init__(sampling_rate=rate)
        self.steps = count()

    def measurement(self, state, acceleration, with_noise=True):
        if with_noise:  # else it is their record of the truth, which must not use up draws
            draws = generator("plant/step", SCENE, 0, next(self.steps))
            np.random.seed(draws.integers(2**32))
            return super().measurement(state, acceleration)
        kept = np.random.get_state()
        exact = super().measurement(state, acceleration, with_noise=False)
        np.random.set_state(kept)
        return exact


class FedForward:
    """What their user would write around their controller."""

    def __init__(self, se3, ukf):
        self.se3, self.ukf = se3, ukf

    def update(self, t, state, flat):
        air = self.ukf.filter.x[6:] - self.ukf.filter.x[3:6]
        drag = np.array([self.ukf.c_Dx, self.ukf.c_Dy, self.ukf.c_Dz])
        push = drag * air * np.linalg.norm(air) / self.ukf.mass
        turned = Rotation.from_euler("zyx", self.ukf.filter.x[:3]).apply(push)
        return self.se3.update(t, state, flat | {"x_ddot": flat["x_ddot"] - turned})


def by_themselves(example, fed):
    """Return where one scene is at each step of their own `simulate`."""
    scene = example.start(generator("plant/start", SCENE, 0))
    se3, ukf = SE3Control(quad_params), WindUKF(quad_params, dt=example.DT_S)
    se3.mass, se3.k_eta, ukf.mass = scene["mass"], scene["k_eta"], scene["mass"]
    ukf.c_Dx, ukf.c_Dy, ukf.c_Dz = scene["drag"], scene["drag"], scene["drag_z"]
    _, state, *_ = simulate(
        World.empty((-3, 3, -3, 3, -3, 3)),
        scene["state"],
        scene["vehicle"],
        FedForward(se3, ukf) if fed else se3,
        HoverTraj(),
        scene["wind"],
        Seeded(1 / example.DT_S),
        FirstExact(1 / example.DT_S),
        ukf,
        STEPS * example.DT_S,
        example.DT_S,
        0.25,
        True,
        terminate=False,
    )
    return state["x"][: STEPS + 1]


@pytest.mark.parametrize(("variant", "fed"), [("alone", False), ("fed-forward", True)])
def test_it_flies_in_our_loop_as_in_its_own(example, variant, fed):
    kept = np.random.get_state()[1].copy()
    (outcome,) = attempted(example.create(), variant, (SCENE,)).outcomes
    assert np.array_equal(np.random.get_state()[1], kept)
    theirs = by_themselves(example, fed)
    assert outcome.metrics["offset_m"] == example.offset_m({"place": theirs})
    assert np.abs(theirs[-1]).max() > 1e-3


def test_a_fault_at_one_object_reaches_its_reads_alone(example):
    system = example.create()
    readers = {"controller.mass", "feedforward.mass", "filter.mass"}
    assert set(system.interface.channel("mass").readers) == readers
    exact = attempted(system, "fed-forward", (SCENE,))
    for struck in ("controller", "feedforward", "filter"):
        trial = attempted(system, "fed-forward", (SCENE,), f"mass:scale=0.8@{struck}")
        assert set(faulted(trial)) == {f"{struck}.mass"}
        assert trial.outcomes[0].metrics != exact.outcomes[0].metrics


def test_what_their_objects_share_is_what_the_page_says():
    parts = {
        "controller": SE3Control(quad_params),
        "filter": WindUKF(quad_params),
        "vehicle": Multirotor(quad_params),
    }
    found = [str(each) for each in shared_objects(parts)]
    told = [line for line in found if line.startswith(("mass ", "c_Dx ", "k_eta "))]
    assert len(told) == 3
    page = (ROOT / "docs" / "rotorpy.md").read_text("utf-8")
    assert all(line in page for line in told)
