"""A robot of the FIRST Robotics Competition drives with WPILib's objects, none of them changed.

Odometry and wheel command read one wheel diameter. The repair tells odometry to trust vision more.

    faultpath audit examples/wpilib_wheels.py:create --baseline default --repair trusting \
        --fault diameter:scale=1.05 --scenes 300
"""

# --- robot ---
import numpy as np
from wpimath.controller import LTVUnicycleController
from wpimath.estimator import DifferentialDrivePoseEstimator
from wpimath.geometry import Pose2d, Rotation2d, Transform2d, Translation2d, Twist2d
from wpimath.kinematics import DifferentialDriveKinematics
from wpimath.trajectory import TrajectoryConfig, TrajectoryGenerator

from faultpath.system import ComposedSystem, FunctionPlant, Measure, Metric, writes

DT_S, STEPS, JUDGED, LIMIT_M = 0.02, 250, 50, 0.1  # steps: all, the first that is judged
TRUST = {"default": np.ones(3), "trusting": np.array([5.0, 5.0, 0.1 / 0.06])}
SCENES = {"training": range(100), "selection": range(500, 1000), "held-out": range(1000, 1300)}


def array(pose):
    return np.array([pose.x, pose.y, pose.rotation().radians()])


@writes("sighting", of=dict)
def vision(_, camera, time, mount, latency):
    return [*array(Pose2d(*camera[:3]) + Transform2d(*mount).inverse()), time - latency, camera[3]]


def heading(time, gyro, gyro_scale, gyro_drift):
    return Rotation2d((gyro - gyro_drift * time) * gyro_scale)


def estimator(  # theirs takes constants once, when the robot starts
    time, turned, gyro, reference,
    diameter, track, gyro_scale, gyro_drift, state_std, vision_std, trust,
):  # fmt: skip
    angle, rolled = heading(time, gyro, gyro_scale, gyro_drift), turned * diameter / 2
    at = DifferentialDriveKinematics(track), angle, *rolled, Pose2d(*reference[:3])
    return DifferentialDrivePoseEstimator(*at, state_std, vision_std / trust)


@writes("pose", of=estimator)
def odometry(estimator, time, turned, gyro, sighting, diameter, gyro_scale, gyro_drift):
    angle, rolled = heading(time, gyro, gyro_scale, gyro_drift), turned * diameter / 2
    estimator.updateWithTime(time, angle, *rolled)
    if sighting[4]:
        estimator.addVisionMeasurement(Pose2d(*sighting[:3]), sighting[3])
    return array(estimator.getEstimatedPosition())


@writes("command", of=lambda tolerance, effort: LTVUnicycleController(tolerance, effort, DT_S))
def drive(follower, time, pose, reference, diameter, track):  # time: delivered in stored runs
    speeds = follower.calculate(Pose2d(*pose), Pose2d(*reference[:3]), *reference[3:])
    rims = DifferentialDriveKinematics(track).toWheelSpeeds(speeds)
    return np.array([rims.left, rims.right]) * 2 / diameter


# --- scenes ---
KNOWN = {  # unit; least and greatest value in scenes; error to expect, a fraction of the value
    "diameter": ("m", 0.148, 0.157, 0.03),
    "track": ("m", 0.57, 0.63, 0.05),
    "gyro_scale": ("1", 0.98, 1.02, 0.01),
    "gyro_drift": ("rad/s", -0.01, 0.01, 1.0),
    "mount": ("m, m, rad", [0.1, -0.2, -0.3], [0.3, 0.2, 0.3], 0.1),
    "latency": ("s", 0.04, 0.12, 0.3),
    "state_std": ("m, m, rad", *([0.02, 0.02, 0.01],) * 2, 0.5),
    "vision_std": ("m, m, rad", *([0.1, 0.1, 0.1],) * 2, 0.5),
    "tolerance": ("m, m, rad", *([0.0625, 0.125, 2.0],) * 2, 0.5),
    "effort": ("m/s, rad/s", *([1.0, 2.0],) * 2, 0.5),
}
READ = {"time": "s", "turned": "rad", "gyro": "rad", "camera": "m, m, rad, 1", "off": "m"}
READ["reference"] = "m, m, rad, m/s, rad/s"


def start(rng):
    """Draw a robot, which knows its own numbers, and a trajectory across the field."""
    own = {name: rng.uniform(low, high) for name, (_, low, high, _) in KNOWN.items()}
    between = [Translation2d(x, rng.uniform(-1.0, 1.0)) for x in (2, 4)]
    end, limits = Pose2d(6, *rng.uniform([-1, -0.5], [1, 0.5])), (rng.uniform(1.5, 3.0), 2.0)
    course = Pose2d(), between, end, TrajectoryConfig(*limits)  # m/s, m/s^2
    own |= {"course": TrajectoryGenerator.generateTrajectory(*course), "angle": 0.0}
    own |= {"lens": Transform2d(*own["mount"]), "rates": np.zeros(2), "turned": np.zeros(2)}
    own["noise"] = rng.uniform(0.02, 0.15) * np.array([1.0, 1.0, 0.6])  # m, m, rad
    return step(own | {"places": [Pose2d(*rng.normal(0, [0.03, 0.03, 0.02]))]}, np.zeros(2), rng)


def step(state, command, rng):
    """Let the wheels follow their command with a lag and slip a little; read the sensors."""
    rates = state["rates"] + (command - state["rates"]) * DT_S / 0.06
    rolled = rates * DT_S * state["diameter"] / 2 * rng.normal(1, 0.05, 2)
    turn = (rolled[1] - rolled[0]) / state["track"]
    angle, turned = state["angle"] + turn + rng.normal(0, 1e-3), state["turned"] + rates * DT_S
    places = [*state["places"], state["places"][-1].exp(Twist2d(rolled.mean(), 0, turn))]
    now, late = len(places) - 2, round(state["latency"] / DT_S)
    aim, draws, camera = state["course"].sample(now * DT_S), rng.normal(size=4), np.zeros(4)
    if now >= late and now % 5 == 0 and draws[3] > -0.84:  # 10 images a second, tags in 4 of 5
        camera = np.append(array(places[-1 - late] + state["lens"]) + state["noise"] * draws[:3], 1)
    return state | {
        "rates": rates, "angle": angle, "turned": turned, "places": places, "camera": camera,
        "time": now * DT_S, "off": aim.pose.translation().distance(places[-1].translation()),
        "gyro": angle / state["gyro_scale"] + state["gyro_drift"] * now * DT_S,
        "reference": [*array(aim.pose), aim.velocity, aim.velocity * aim.curvature],
    }  # fmt: skip


def create() -> ComposedSystem:
    off_m = Measure(Metric(unit="m", better="less"), lambda seen: seen["off"][JUDGED:].max())
    plant = FunctionPlant(
        start, step, observes={name: name for name in (*KNOWN, *READ)}, action="command",
        steps=STEPS, dt_s=DT_S, succeeded=lambda seen: off_m.of(seen) <= LIMIT_M,
        metrics={"off_m": off_m}, trace=lambda state: array(state["places"][-1])[:2],
    )  # fmt: skip
    units = READ | {"sighting": "m, m, rad, s, 1", "pose": "m, m, rad", "command": "rad/s"}
    for name, (unit, _, _, error) in KNOWN.items():
        expected = {"std": error, "relative": True}
        units[name] = {"unit": unit, "provenance": "estimated", "uncertainty": expected}
    robots = {name: [vision, odometry.given(trust=trust), drive] for name, trust in TRUST.items()}
    return ComposedSystem("wpilib", plant, robots, units, scenes=SCENES)
