"""Basilisk, untouched: it flies in our loop as in its own, and a fault reaches who reads."""

from types import SimpleNamespace

import numpy as np
import pytest

pytest.importorskip("Basilisk")

from Basilisk.architecture import messaging
from Basilisk.fswAlgorithms import (
    attTrackingError,
    eulerRotation,
    inertial3D,
    inertialUKF,
    mrpFeedback,
    rwMotorTorque,
    stComm,
)
from Basilisk.simulation import reactionWheelStateEffector, simpleNav, spacecraft, starTracker
from Basilisk.utilities import SimulationBaseClass
from foreign_trials import ROOT, attempted, faulted, loaded

from faultpath import generator
from faultpath.system import FunctionPlant, shared_objects

EXAMPLE = ROOT / "examples" / "basilisk_attitude.py"
SCENE, STEPS = "seed/7", 300


@pytest.fixture
def example(monkeypatch):
    """The example, flown for a shorter time and without errors of its sensors."""
    module = loaded(EXAMPLE)
    module.TRACKER = module.BIAS = module.NOISE = 0.0
    module.episodes = []

    def plant(*given, **named):
        named |= {"steps": STEPS, "succeeded": lambda each: module.episodes.append(each) or True}
        return FunctionPlant(*given, **named)

    module.FunctionPlant = plant
    return module


def theirs(example, variant):
    """Return their closed loop as their scenarios write one: a process, two tasks, no taps."""
    sim = SimulationBaseClass.SimBaseClass()
    process = sim.CreateNewProcess("all")
    process.addTask(sim.CreateNewTask("dynamics", example.TICK // 5), 2)
    process.addTask(sim.CreateNewTask("software", example.TICK, None, example.TICK), 1)
    body, nav = spacecraft.Spacecraft(), simpleNav.SimpleNav()
    rotors = reactionWheelStateEffector.ReactionWheelStateEffector()
    camera, tracker = starTracker.StarTracker(), stComm.stComm()
    point, sweep = inertial3D.inertial3D(), eulerRotation.eulerRotation()
    error, law = attTrackingError.attTrackingError(), mrpFeedback.mrpFeedback()
    motor, ukf = rwMotorTorque.rwMotorTorque(), inertialUKF.inertialUKF()

    rng = generator("plant/start", SCENE, 0)
    body.hub.sigma_BNInit = rng.uniform(-0.05, 0.05, 3).tolist()
    body.hub.omega_BN_BInit = rng.normal(0, np.radians(0.25), 3).tolist()
    body.hub.IHubPntBc_B = [[900.0, 0, 0], [0, 800.0, 0], [0, 0, 600.0]]
    rng.normal(size=3)
    wheels = example.wheels(example.RPM * rng.uniform(0.95, 1.05, 3))
    wheels.addToSpacecraft("craft", rotors, body)
    inertia = messaging.VehicleConfigMsgPayload(ISCPntB_B=[900.0, 0, 0, 0, 800.0, 0, 0, 0, 600.0])
    vehicle = messaging.VehicleConfigMsg().write(inertia)
    gyro = messaging.AccDataMsg().write(messaging.AccDataMsgPayload())

    sweep.angleRates, motor.controlAxes_B = [0, 0.002, 0], [1, 0, 0, 0, 1, 0, 0, 0, 1]
    law.K, law.P, law.Ki = 3.5, 30.0, -1.0
    tracker.dcm_BP = [1, 0, 0, 0, 1, 0, 0, 0, 1]
    seen = inertialUKF.STMessage()
    seen.noise = (0.00017**2 * np.eye(3)).ravel().tolist()
    ukf.alpha, ukf.beta, ukf.switchMag = 0.02, 2.0, 1.2
    ukf.covarInit = (np.diag([0.2] * 3 + [0.004**0.5] * 3) ** 2).ravel().tolist()
    ukf.qNoise = (np.diag([0.0017] * 3 + [0.00017] * 3) ** 2).ravel().tolist()

    rotors.rwMotorCmdInMsg.subscribeTo(motor.rwMotorTorqueOutMsg)
    nav.scStateInMsg.subscribeTo(body.scStateOutMsg)
    camera.scStateInMsg.subscribeTo(body.scStateOutMsg)
    tracker.stSensorInMsg.subscribeTo(camera.sensorOutMsg)
    seen.stInMsg.subscribeTo(tracker.stAttOutMsg)
    ukf.STDatasStruct.STMessages, ukf.STDatasStruct.numST = [seen], 1
    sweep.attRefInMsg.subscribeTo(point.attRefOutMsg)
    error.attRefInMsg.subscribeTo(sweep.attRefOutMsg)
    error.attNavInMsg.subscribeTo(nav.attOutMsg if variant == "gyro" else ukf.navStateOutMsg)
    law.guidInMsg.subscribeTo(error.attGuidOutMsg)
    motor.vehControlInMsg.subscribeTo(law.cmdTorqueOutMsg)
    config = wheels.getConfigMessage()
    for part in (law, motor, ukf):
        part.rwParamsInMsg.subscribeTo(config)
    for part in (law, ukf):
        part.rwSpeedsInMsg.subscribeTo(rotors.rwSpeedOutMsg)
    law.vehConfigInMsg.subscribeTo(vehicle)
    ukf.massPropsInMsg.subscribeTo(vehicle)
    ukf.gyrBuffInMsg.subscribeTo(gyro)

    for part in (rotors, body, nav, camera):
        sim.AddModelToTask("dynamics", part)
    for part in (tracker, ukf, point, sweep, error, law, motor):
        sim.AddModelToTask("software", part)
    log = body.scStateOutMsg.recorder(example.TICK)
    sim.AddModelToTask("dynamics", log)
    sim.InitializeSimulation()
    sim.ConfigureStopTime((STEPS + 1) * example.TICK)
    sim.ExecuteSimulation()
    flown = np.hstack([log.sigma_BN, log.omega_BN_B])[1:]
    return SimpleNamespace(flown=flown, ukf=ukf, law=law, rotors=rotors)


@pytest.mark.parametrize("variant", ["gyro", "filtered"])
def test_it_flies_in_our_loop_as_in_its_own(example, variant):
    attempted(example.create(), variant, (SCENE,))
    own = theirs(example, variant)
    assert np.allclose(example.episodes[0]["sensed"], own.flown, rtol=0, atol=1e-12)


def test_the_messages_that_they_share_are_found(example):
    own = theirs(example, "gyro")
    found = shared_objects({"inertialUKF": own.ukf, "mrpFeedback": own.law})
    assert {each.what for each in found} == {"VehicleConfigMsg", "RWArrayConfigMsg"}
    for module in (own.ukf, own.law):  # one of a module is another object whenever it is asked for
        assert module.rwSpeedsInMsg.isSubscribedTo(own.rotors.rwSpeedOutMsg)


def test_a_fault_reaches_who_reads(example):
    fault = "wheel_speeds:freeze@filter,onset_s=50"
    trial = attempted(example.create(), "filtered", (SCENE,), fault)
    assert faulted(trial) == {"filter.wheel_speeds": STEPS - 100}
