"""WPILib's objects, untouched: our loop is a robot's own, and a fault reaches who reads."""

import inspect

import numpy as np
import pytest
from foreign_trials import ROOT, attempted, faulted, lines, loaded

pytest.importorskip("wpimath", reason="robotpy-wpimath is not installed")

from wpimath.controller import LTVUnicycleController
from wpimath.estimator import DifferentialDrivePoseEstimator
from wpimath.geometry import Pose2d, Rotation2d, Transform2d
from wpimath.kinematics import DifferentialDriveKinematics

from faultpath import generator
from faultpath.core.errors import SystemMistake
from faultpath.loop import Inputs, Port
from faultpath.system import tapped, writes

EXAMPLE = ROOT / "examples" / "wpilib_wheels.py"
SCENE, STEPS = "seed/3", 120
FAULT = "diameter:scale=1.05"


@pytest.fixture(scope="module")
def wheels():
    """The example, with shorter trials."""
    module = loaded(EXAMPLE)
    module.STEPS = STEPS
    return module


class Robot:
    """What a team writes: the same objects and calls, and nothing of ours."""

    def __init__(self, own, vision_std):
        self.own, self.kinematics = own, DifferentialDriveKinematics(own["track"])
        self.follower = LTVUnicycleController(own["tolerance"], own["effort"], 0.02)
        pose, angle = Pose2d(*own["reference"][:3]), Rotation2d(self.heading(0.0, own["gyro"]))
        self.estimator = DifferentialDrivePoseEstimator(
            self.kinematics, angle, *self.rolled(own["turned"]), pose, own["state_std"], vision_std
        )

    def heading(self, time, gyro):
        return (gyro - self.own["gyro_drift"] * time) * self.own["gyro_scale"]

    def rolled(self, turned):
        return turned * self.own["diameter"] / 2

    def periodic(self, time, turned, gyro, camera, aim):
        heading = Rotation2d(self.heading(time, gyro))
        self.estimator.updateWithTime(time, heading, *self.rolled(turned))
        if camera[3]:
            seen = Pose2d(*camera[:3]) + Transform2d(*self.own["mount"]).inverse()
            self.estimator.addVisionMeasurement(seen, time - self.own["latency"])
        pose = self.estimator.getEstimatedPosition()
        speeds = self.follower.calculate(pose, Pose2d(*aim[:3]), *aim[3:])
        rims = self.kinematics.toWheelSpeeds(speeds)
        return np.array([rims.left, rims.right]) * 2 / self.own["diameter"]


def worst_alone(wheels, vision_std):
    """Return how far off the robot is that a team's own code drives."""
    state = wheels.start(generator("plant/start", SCENE, 0))
    robot, off = Robot(state, vision_std), [state["off"]]
    for step in range(STEPS):
        seen = (state[name] for name in ("time", "turned", "gyro", "camera", "reference"))
        state = wheels.step(state, robot.periodic(*seen), generator("plant/step", SCENE, 0, step))
        off.append(state["off"])
    return max(off[wheels.JUDGED :])


@pytest.mark.parametrize(
    ("variant", "vision_std"), [("default", (0.1, 0.1, 0.1)), ("trusting", (0.02, 0.02, 0.06))]
)
def test_without_a_fault_it_drives_as_a_teams_own_code_to_the_bit(wheels, variant, vision_std):
    (outcome,) = attempted(wheels.create(), variant, (SCENE,)).outcomes
    used = np.full(3, 0.1) / wheels.TRUST[variant]
    assert used == pytest.approx(vision_std, rel=1e-15)
    assert outcome.metrics["off_m"] == worst_alone(wheels, used)


def test_the_baseline_has_the_standard_deviations_that_wpilib_starts_with():
    moved = []
    for more in ((), ((0.02, 0.02, 0.01), (0.1, 0.1, 0.1))):
        kinematics = DifferentialDriveKinematics(0.6)
        estimator = DifferentialDrivePoseEstimator(
            kinematics, Rotation2d(), 0.0, 0.0, Pose2d(), *more
        )
        estimator.updateWithTime(0.0, Rotation2d(), 0.0, 0.0)
        estimator.addVisionMeasurement(Pose2d(1.0, 0.5, 1.0), 0.0)
        pose = estimator.getEstimatedPosition()
        moved.append((pose.x, pose.y, pose.rotation().radians()))
    assert moved[0] == moved[1]
    assert moved[0][0] == pytest.approx(1 / 6)


@pytest.mark.parametrize(
    ("fault", "changes"),
    [
        (f"{FAULT}@odometry", True),
        (f"{FAULT}@drive", True),
        ("track:scale=1.2@drive", True),
        ("track:scale=1.2@odometry", False),  # with a gyro WPILib takes no heading from the wheels
        ("latency:offset=0.1@vision", True),
    ],
)
def test_a_fault_at_one_reader_reaches_that_reader_alone(wheels, fault, changes):
    system = wheels.create()
    exact, trial = (attempted(system, "default", (SCENE,), text) for text in ("", fault))
    channel, _, reader = fault.replace("@", ":").split(":")
    assert faulted(trial) == {f"{reader}.{channel}": STEPS}
    assert (trial.outcomes[0].metrics != exact.outcomes[0].metrics) is changes


def test_compiled_code_is_tapped_where_it_is_called_by_the_name_of_an_argument():
    def made_with(argument):
        module = writes("track", of=lambda: tapped(DifferentialDriveKinematics, argument, at="a"))(
            lambda kinematics: kinematics().trackWidth
        )
        reads = {Port(argument, f"a.{argument.lower()}"): np.array([0.7])}
        return module.step(Inputs("module", 0, reads, {}), [None])[0]["track"]

    assert made_with("trackWidth") == [0.7]
    with pytest.raises(SystemMistake, match="calls DifferentialDriveKinematics, which is compiled"):
        made_with("track")


def test_ten_parameters_say_how_wrong_they_may_be(wheels):
    interface = wheels.create().interface
    said = {s.name for s in interface.sources if s.expected_uncertainty}
    assert said == set(wheels.KNOWN)
    assert len(said) == 10
    readers = {name: set(interface.channel(name).readers) for name in ("diameter", "track")}
    assert readers == {n: {f"drive.{n}", f"odometry.{n}"} for n in ("diameter", "track")}


def test_faultpath_takes_few_lines_beside_a_teams_own_code():
    robot = EXAMPLE.read_text("utf-8").partition("\ndef array")[2].partition("# --- scenes")[0]
    ours, theirs = lines(f"def array{robot}"), lines(inspect.getsource(Robot))
    assert 0 < ours - theirs <= 15
    page = " ".join((ROOT / "docs" / "wpilib.md").read_text("utf-8").split())
    assert f"{ours} lines of code; a team's own code with the same calls takes {theirs}" in page
