"""A motor drive that nobody here wrote: motulator's sensorless controller (Python 3.12 or newer).

One object of machine parameters goes to three parts of it, and each reads the flux of the magnets,
`psi_f`, at every step: `reference_gen` chooses currents for a torque, `current_ctrl` voltages for
currents, and `observer`, with a copy of its own, finds the rotor's angle without a sensor.
Baseline `fixed`: the observer believes the flux that it is given. Repair `adapted`: it corrects its
copy, with the gain of their example. Fault: magnets 100 K hotter than when the drive was set up
have lost a tenth of their flux, so that all three read it too high, by 1/0.9.

    faultpath audit examples/motulator_drive.py:create --baseline fixed --repair adapted \
        --fault psi_f:scale=1.11 --scenes 80
"""

from math import pi
from types import SimpleNamespace

import motulator.drive.control.sm as control
import numpy as np
from motulator.drive import model, utils

from faultpath.system import ComposedSystem, FunctionPlant, Measure, Metric, Parts, tapped, writes

T_S, STEPS, ORDERED_S = 250e-6, 2400, 0.2  # the torque is ordered after 0.2 s of 0.6 s
NOMINAL = utils.NominalValues(U=370, I=4.3, f=75, P=2.2e3, tau=14)
BASE = utils.BaseValues.from_nominal(NOMINAL, n_p=3)
SHEET = {"n_p": 3, "L_d": 0.036, "L_q": 0.051}
UNITS = {"currents": "A", "dc_voltage": "V", "torque_ref": "N m", "torque": "N m", "psi_f": "V s"}


# --- controller ---
def controller(adapts=False):
    """Return their controller, made of the data sheet's values as in their examples."""
    k_f = (lambda w_m: max(0.05 * (abs(w_m) - 0.2 * BASE.w), 0)) if adapts else None
    par = model.SynchronousMachinePars(**SHEET, R_s=3.6, psi_f=0.545)
    cfg = control.CurrentVectorControllerCfg(
        1.5 * BASE.i, alpha_o=2 * pi * 100, k_f=k_f, psi_s_min=0.0, online_ref=True, T_s=T_S
    )
    return control.VectorControlSystem(control.CurrentVectorController(par, cfg))


def tapped_controller(adapts=False):
    made = controller(adapts)
    parts, flux = made.vector_ctrl, made.vector_ctrl.observer.flux_observer
    parts.reference_gen.par = tapped(parts.reference_gen.par, "psi_f", at="reference_gen")
    parts.current_ctrl.par = tapped(parts.current_ctrl.par, "psi_f", at="current_ctrl")
    flux.par = tapped(flux.par, "psi_f", at="observer")
    return made


def drive(made, currents, dc_voltage, torque_ref):
    """Let their controller make a step of what was measured."""
    machine = SimpleNamespace(meas_currents=lambda: currents)
    converter = SimpleNamespace(meas_dc_voltage=lambda: float(dc_voltage))
    made.set_torque_ref(float(torque_ref))
    return made(SimpleNamespace(machine=machine, converter=converter, lc_filter=None))[1]


# --- plant ---
class Given:
    """Stands for the controller in their simulation, and hands on what was delivered."""

    duty, get_enable = None, staticmethod(lambda: True)

    def __call__(self, mdl):
        return T_S, self.duty


def simulation(rng, ctrl):
    """Return a simulation of theirs, of one scene, and the torque that is ordered in it."""
    speed = rng.uniform(0.2, 1.0) * BASE.w_M
    torque = rng.choice([-1, 1]) * rng.uniform(0.3, 1.0) * NOMINAL.tau
    warm, flux = rng.uniform(0.0, 100.0), rng.uniform(0.95, 1.05)  # K; of the data sheet's
    gain, offset = 1 + rng.uniform(-0.03, 0.03, 3), rng.uniform(-0.03, 0.03, 3) * BASE.i
    noise = np.random.default_rng(rng.integers(2**32))
    par = model.SynchronousMachinePars(**SHEET, R_s=3.6 * (1 + 0.0039 * warm), psi_f=0.545 * flux)
    machine = model.SynchronousMachine(par, model.Sensor(gain, offset, 0.005 * BASE.i, noise))
    shaft = model.ExternalRotorSpeed()
    shaft.set_external_rotor_speed(lambda t: speed * min(t / 0.1, 1.0))
    mdl = model.Drive(machine, shaft, model.VoltageSourceConverter(u_dc=540))
    return model.Simulation(mdl, ctrl, show_progress=False), torque


def seen(sim, torque):
    machine = sim.mdl.machine
    now = machine.meas_currents(), sim.mdl.converter.meas_dc_voltage()
    told = torque * (sim.mdl.t0 > ORDERED_S), machine.out.tau_M, machine.par.psi_f
    return dict(zip(UNITS, (*now, *told), strict=True)) | {"sim": sim, "ordered": torque}


def step(state, duty, rng):
    """Run their loop over one period of control."""
    state["sim"].ctrl.duty = duty
    state["sim"]._run_simulation_loop(state["sim"].mdl.t0, lambda: None, 0)
    return seen(state["sim"], state["ordered"])


def error_percent(episode):
    """Return how far the torque was from its order in the last 0.1 s, % of the nominal torque."""
    return 100 * abs(episode["torque"] - episode["torque_ref"])[-400:].max() / NOMINAL.tau


def create() -> ComposedSystem:
    plant = FunctionPlant(
        lambda rng: seen(*simulation(rng, Given())),
        step,
        observes={name: name for name in UNITS},
        action="duty",
        steps=STEPS,
        dt_s=T_S,
        succeeded=lambda episode: bool(error_percent(episode) <= 5.0),
        metrics={"torque_error": Measure(Metric(unit="%", better="less"), error_percent)},
    )
    parts = {
        "fixed": ("The observer believes the flux that it is given.", tapped_controller),
        "adapted": ("The observer adapts its flux.", lambda: tapped_controller(True)),
    }
    variants = {n: Parts(said, [writes("duty", of=of)(drive)]) for n, (said, of) in parts.items()}
    more = {"psi_f": {"unit": "V s", "provenance": "estimated"}, "duty": "1"}
    return ComposedSystem("motulator", plant, variants, UNITS | more)
