"""A spacecraft with reaction wheels that nobody here wrote: Basilisk's (`docs/basilisk.md`).

Two parts of its flight software read the speeds that the encoders of the wheels report:

    filter      inertialUKF, for attitude and rates; it also reads a star tracker
    control     five modules for a sweep; mrpFeedback feeds forward the momentum in the wheels

Baseline `gyro`: control has its rates from a gyroscope. Repair `filtered`: from the filter.

    faultpath audit examples/basilisk_attitude.py:create --baseline gyro --repair filtered \
        --fault wheel_speeds:freeze,onset_s=300
"""

from importlib import import_module

import numpy as np
from Basilisk.architecture import messaging
from Basilisk.fswAlgorithms import inertialUKF
from Basilisk.simulation import reactionWheelStateEffector, spacecraft
from Basilisk.utilities import RigidBodyKinematics, SimulationBaseClass, simIncludeRW

from faultpath.system import ComposedSystem, FunctionPlant, writes

TICK, SWEEP, INERTIA = 500_000_000, 0.002, np.diag([900.0, 800.0, 600.0])  # ns, rad/s, kg m^2
RPM = np.array([100.0, 200.0, 300.0])  # the wheels at the start
TRACKER, BIAS, NOISE = 0.00017 / 4, 1e-4, 1e-5  # MRP of 0.00017 rad; rad/s, 20 deg/h; rad/s


# --- taps ---
def given(target, values):
    for name, value in values.items():
        setattr(target, name, np.ravel(value).tolist() if np.ndim(value) else value)
    return target


def write(message, ns=0, **values):
    """Write a message of our own, which inputs of theirs read in place of the shared one."""
    return message.write(given(message.zeroMsgPayload, values), ns)


def wheels(speeds_rpm):
    factory = simIncludeRW.rwFactory()
    for axis, speed in zip(np.eye(3).tolist(), speeds_rpm, strict=True):
        factory.create("Honeywell_HR16", axis, maxMomentum=50.0, Omega=speed)
    return factory


class Software:
    """Modules of theirs that run in turn, with two taps: a sensor of their own, and the wheels."""

    def __init__(self, sensed):
        self.ns, self.modules, self.sensed = 0, [], write(sensed)
        self.speeds, config = write(messaging.RWSpeedMsg()), wheels([0.0] * 3).getConfigMessage()
        vehicle = write(messaging.VehicleConfigMsg(), ISCPntB_B=INERTIA)
        self.read = {"rwSpeeds": self.speeds, "rwParams": config}
        self.read |= {"vehConfig": vehicle, "massProps": vehicle}

    def add(self, name, inputs, **settings):
        module = getattr(import_module(f"Basilisk.fswAlgorithms.{name}"), name)()
        for key, message in (self.read | inputs).items():
            if hasattr(module, f"{key}InMsg"):
                getattr(module, f"{key}InMsg").subscribeTo(message)
        self.modules.append(given(module, settings))
        module.SelfInit()
        module.Reset(0)
        return module

    def run(self, wheel_speeds, **sensed):
        self.ns += TICK
        write(self.sensed, self.ns, **sensed)
        write(self.speeds, self.ns, wheelSpeeds=wheel_speeds)
        for module in self.modules:
            module.UpdateState(self.ns)
        return self.modules[-1]


# --- modules ---
def estimator():
    of, tracker = Software(messaging.STAttMsg()), inertialUKF.STMessage()
    ukf = {"alpha": 0.02, "beta": 2.0, "switchMag": 1.2}  # and the numbers below: as in their test
    ukf |= {"covarInit": np.diag([0.2] * 3 + [0.004**0.5] * 3) ** 2}
    ukf |= {"qNoise": np.diag([0.0017] * 3 + [0.00017] * 3) ** 2}
    given(tracker, {"noise": np.eye(3) * 0.00017**2}).stInMsg.subscribeTo(of.sensed)
    data = of.add("inertialUKF", {"gyrBuff": write(messaging.AccDataMsg())}, **ukf).STDatasStruct
    data.STMessages, data.numST = [tracker], 1
    return of


@writes("filtered", of=estimator)
def filter(of, sensed, wheel_speeds):
    ukf = of.run(wheel_speeds, MRP_BdyInrtl=sensed[:3], timeTag=of.ns + TICK)
    return [*ukf.navStateOutMsg.read().sigma_BN, *ukf.navStateOutMsg.read().omega_BN_B]


def sweeping():
    of = Software(messaging.NavAttMsg())
    course = of.add("inertial3D", {}).attRefOutMsg
    course = of.add("eulerRotation", {"attRef": course}, angleRates=[0, SWEEP, 0]).attRefOutMsg
    error = of.add("attTrackingError", {"attRef": course, "attNav": of.sensed}).attGuidOutMsg
    torque = of.add("mrpFeedback", {"guid": error}, K=3.5, P=30.0, Ki=-1.0).cmdTorqueOutMsg
    of.add("rwMotorTorque", {"vehControl": torque}, controlAxes_B=np.eye(3))
    return of


@writes("torque", of=sweeping)
def control(of, navigation, wheel_speeds):
    motor = of.run(wheel_speeds, sigma_BN=navigation[:3], omega_BN_B=navigation[3:])
    return motor.rwMotorTorqueOutMsg.read().motorTorque[:3]


# --- plant ---
class Craft:
    """Their simulation of a spacecraft with three wheels, and sensors on it."""

    def __init__(self, rng):
        self.ns, self.torque = 0, messaging.ArrayMotorTorqueMsg()
        self.sim, self.body = SimulationBaseClass.SimBaseClass(), spacecraft.Spacecraft()
        self.rotors = reactionWheelStateEffector.ReactionWheelStateEffector()
        tilt, spin = rng.uniform(-0.05, 0.05, 3), rng.normal(0, np.radians(0.25), 3)
        given(self.body.hub, {"sigma_BNInit": tilt, "omega_BN_BInit": spin})
        self.body.hub.IHubPntBc_B, self.bias = INERTIA.tolist(), rng.normal(0, BIAS, 3)
        wheels(RPM * rng.uniform(0.95, 1.05, 3)).addToSpacecraft("craft", self.rotors, self.body)
        self.rotors.rwMotorCmdInMsg.subscribeTo(self.torque)
        self.sim.CreateNewProcess("craft").addTask(self.sim.CreateNewTask("task", TICK // 5))
        self.sim.AddModelToTask("task", self.rotors)
        self.sim.AddModelToTask("task", self.body)
        self.sim.InitializeSimulation()

    def move(self, torque, rng):
        target = np.array([0, np.tan(SWEEP * self.ns * 1e-9 / 4), 0])
        write(self.torque, self.ns, motorTorque=torque)
        self.ns += TICK
        self.sim.ConfigureStopTime(self.ns)
        self.sim.ExecuteSimulation()
        body, noise = self.body.scStateOutMsg.read(), rng.normal(size=(2, 3))
        seen = body.sigma_BN + TRACKER * noise[0], body.omega_BN_B + self.bias + NOISE * noise[1]
        off = np.linalg.norm(RigidBodyKinematics.subMRP(np.array(body.sigma_BN), target))
        speeds = np.array(self.rotors.rwSpeedOutMsg.read().wheelSpeeds[:3])
        readings = {"craft": self, "sensed": np.concatenate(seen), "wheel_speeds": speeds}
        return readings | {"error_deg": np.degrees(4 * np.arctan(off))}


# --- system ---
def create() -> ComposedSystem:
    plant = FunctionPlant(
        lambda rng: Craft(rng).move(np.zeros(3), rng),
        lambda state, torque, rng: state["craft"].move(torque, rng),
        observes={name: name for name in ("sensed", "wheel_speeds", "error_deg")},
        action="torque",
        steps=1200,
        dt_s=TICK * 1e-9,
        succeeded=lambda episode: episode["error_deg"][-240:].max() <= 0.5,
    )
    units = {"wheel_speeds": "rad/s", "error_deg": "deg", "torque": "N m"}
    units |= {"sensed": "1, rad/s", "filtered": "1, rad/s"}
    variants = {"gyro": [control], "filtered": [filter, control]}
    channels = {"navigation": ("sensed", "filtered")}
    return ComposedSystem("basilisk", plant, variants, units, channels)
