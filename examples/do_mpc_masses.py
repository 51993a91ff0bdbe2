"""do-mpc's rotating masses: three discs on springs between two motors, with their MHE and MPC.

Model, horizons, weights, bounds and noise are their example's. Baseline `fixed`: MHE and MPC take
the inertias from a calibration. Repair `estimated`: the MHE estimates that of disc 1 for both.

    faultpath audit examples/do_mpc_masses.py:create --baseline fixed --repair estimated \
        --fault inertia:scale=1.1 --scenes 80
"""

from warnings import catch_warnings

import numpy as np

from faultpath.system import ComposedSystem, FunctionPlant, Measure, Metric, Parts, writes

with catch_warnings(action="ignore"):  # about optional parts of do-mpc
    import do_mpc
    from casadi import DM, GlobalOptions, diff, vertcat

GlobalOptions.setNumpyMode(-1)  # what do-mpc is written for, without a notice of it
NOMINAL, STEPS, TURN, JUDGED = 2.25e-4, 50, 25, 35  # kg m^2; steps: all, setpoint changes, judged
IPOPT = {"ipopt.linear_solver": "mumps", "ipopt.print_level": 0, "ipopt.sb": "yes", "print_time": 0}
LIMITS = ("_u", "phi_m_set", -5, 5), ("_x", "dphi", -6, 6), ("_p_est", "Theta_1", 1e-5, 1e-3)
WEIGHTS = 1e-4 * np.eye(8), np.diag([1.0, 1.0, 1.0, 20.0, 20.0]), np.eye(1)
SPRINGS, DAMPING = DM([2.697e-3, 2.66e-3, 3.05e-3, 2.86e-3]), DM([6.78e-5, 8.01e-5, 8.82e-5])
MODEL = do_mpc.model.Model("continuous")
ANGLES, RATES = (MODEL.set_variable("_x", name, (3, 1)) for name in ("phi", "dphi"))
MOTORS = MODEL.set_variable("_x", "phi_m", (2, 1))
ORDERS = MODEL.set_variable("_u", "phi_m_set", (2, 1))
SETPOINT = MODEL.set_variable("_tvp", "setpoint")
INERTIAS = [MODEL.set_variable("_p", f"Theta_{i}") for i in (1, 2, 3)]
TORQUES = SPRINGS * -diff(vertcat(MOTORS[0], ANGLES, MOTORS[1]))
MODEL.set_rhs("phi", RATES)
MODEL.set_rhs("dphi", (-diff(TORQUES) - DAMPING * RATES) / vertcat(*INERTIAS))
MODEL.set_rhs("phi_m", (ORDERS - MOTORS) / 1e-2)
MODEL.set_meas("encoders", vertcat(ANGLES, ORDERS))
MODEL.setup()


def ready(solver, limits=(), scenarios=(), **settings):
    """Set up an object of theirs; return it with what it looks up at each of its steps."""
    known = {"inertia": NOMINAL, "setpoint": 0.0}
    solver.set_param(t_step=0.1, **settings)
    inertias, course = solver.get_p_template(*scenarios), solver.get_tvp_template()
    solver.set_p_fun(lambda _: inertias(known["inertia"]))
    solver.set_tvp_fun(lambda _: course(known["setpoint"]))
    for kind, name, low, high in limits:
        solver.bounds["lower", kind, name], solver.bounds["upper", kind, name] = low, high
    solver.setup()
    solver.set_initial_guess()
    return solver, known


def mhe_of(estimates):
    mhe = do_mpc.estimator.MHE(MODEL, ["Theta_1"][:estimates])
    mhe.set_default_objective(*WEIGHTS[: 2 + estimates])
    mhe.p_est0 = np.full(estimates, NOMINAL)
    return ready(mhe, LIMITS[: 2 + estimates], n_horizon=10, meas_from_data=True, nlpsol_opts=IPOPT)


def mpc_of():
    mpc = do_mpc.controller.MPC(MODEL)
    mpc.set_objective(DM(1), (ANGLES[1] - SETPOINT) ** 2)
    mpc.set_rterm(phi_m_set=1e-2)
    return ready(mpc, LIMITS[:1], [1], n_horizon=20, nlpsol_opts=IPOPT)


# --- modules ---
def modules(estimates):
    @writes("belief", of=lambda: mhe_of(estimates))
    def estimator(estimation, encoders, inertia):
        mhe, known = estimation
        known["inertia"] = inertia[estimates:]
        state = mhe.make_step(encoders[:, None])
        moment = mhe.opt_x_num["_p_est"] if estimates else mhe.opt_p_num["_p_set"]
        return np.append(state, moment.full()[0])  # the inertia of disc 1 as this MHE has it

    @writes("command", of=mpc_of)
    def controller(control, belief, inertia, setpoint):
        mpc, known = control
        known.update(inertia=[*belief[8:][:estimates], *inertia[estimates:]], setpoint=setpoint)
        return mpc.make_step(belief[:8, None])[:, 0]

    return [estimator, controller]


# --- scenes ---
def start(rng):
    simulator, known = ready(do_mpc.simulator.Simulator(MODEL))
    known["inertia"] = NOMINAL * rng.uniform(0.9, 1.1, 3)
    simulator.x0 = rng.uniform(-0.5, 0.5, 8)
    course = np.where(np.arange(STEPS + 21) < TURN, 0.0, rng.uniform(-0.5, 0.5) * np.pi)
    return advance(known | {"simulator": simulator, "course": course, "step": -1}, np.zeros(2), rng)


def advance(state, command, rng):
    simulator, step = state["simulator"], state["step"] + 1
    seen = simulator.make_step(command[:, None], v0=1e-2 * rng.standard_normal((5, 1)))
    read = {"step": step, "encoders": seen[:, 0], "setpoint": state["course"][step : step + 21]}
    return state | read | {"off": abs(float(simulator.x0["phi", 1]) - read["setpoint"][0])}


def create() -> ComposedSystem:
    off_rad = Measure(Metric(unit="rad", better="less"), lambda seen: seen["off"][JUDGED:].max())
    plant = FunctionPlant(
        start,
        advance,
        observes={name: name for name in ("encoders", "inertia", "setpoint", "off")},
        action="command",
        steps=STEPS,
        dt_s=0.1,
        succeeded=lambda episode: off_rad.of(episode) <= 0.03,  # three deviations of the noise
        metrics={"off_rad": off_rad},
    )
    fixed = Parts("Both take all inertias from the calibration.", modules(0))
    estimated = Parts("The MHE estimates the inertia of disc 1 for both.", modules(1))
    unit = dict.fromkeys(("encoders", "setpoint", "off", "command"), "rad")
    unit |= {"inertia": {"unit": "kg m^2", "provenance": "estimated"}, "belief": "rad, 1/s, kg m^2"}
    return ComposedSystem("rotating_masses", plant, {"fixed": fixed, "estimated": estimated}, unit)
