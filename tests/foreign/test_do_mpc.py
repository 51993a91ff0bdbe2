"""do-mpc's rotating masses behind taps: the loop is theirs, and a fault reaches who reads."""

import numpy as np
import pytest
from foreign_trials import ROOT, attempted, faulted, loaded

from faultpath import generator
from faultpath.system import shared_objects

do_mpc = pytest.importorskip("do_mpc")
PAGE = ROOT / "docs" / "do-mpc.md"
STEPS, TURN, JUDGED = 12, 3, 8


@pytest.fixture(scope="module")
def masses():
    """The example, with shorter trials."""
    module = loaded(ROOT / "examples" / "do_mpc_masses.py")
    module.STEPS, module.TURN, module.JUDGED = STEPS, TURN, JUDGED
    return module


def worst_alone(masses, scene, estimates):
    """Return how far off the disc is in do-mpc's own loop, in which nothing of ours runs."""
    state = masses.start(generator("plant/start", scene, 0))
    simulator, inertia = state["simulator"], state["inertia"]
    (mhe, at_mhe), (mpc, at_mpc) = masses.mhe_of(estimates), masses.mpc_of()
    at_mhe["inertia"] = inertia[estimates:]
    seen, off = state["encoders"], []
    for step in range(STEPS):
        belief = mhe.make_step(seen[:, None])
        first = mhe.opt_x_num["_p_est"].full()[0, 0] if estimates else inertia[0]
        at_mpc["inertia"] = [first, *inertia[1:]]
        at_mpc["setpoint"] = state["course"][step : step + 21]
        noise = generator("plant/step", scene, 0, step).standard_normal((5, 1))
        seen = simulator.make_step(mpc.make_step(belief), v0=1e-2 * noise)[:, 0]
        off.append(abs(float(simulator.x0["phi", 1]) - state["course"][step + 1]))
    return max(off[JUDGED - 1 :])


@pytest.mark.parametrize(("variant", "estimates"), [("fixed", 0), ("estimated", 1)])
def test_without_a_fault_the_loop_is_theirs_to_the_bit(masses, variant, estimates):
    scenes = ("seed/3", "seed/4")
    flown = attempted(masses.create(), variant, scenes).outcomes
    found = [outcome.metrics["off_rad"] for outcome in flown]
    assert found == [worst_alone(masses, scene, estimates) for scene in scenes]


def test_a_fault_at_one_reader_reaches_that_reader_alone(masses):
    system, scenes = masses.create(), ("seed/3",)
    clean = attempted(system, "estimated", scenes).outcomes[0].metrics["off_rad"]
    for struck in ("estimator", "controller"):
        done = attempted(system, "estimated", scenes, f"inertia:scale=1.1@{struck}")
        assert faulted(done) == {f"{struck}.inertia": STEPS}
        assert done.outcomes[0].metrics["off_rad"] != clean


def test_what_their_objects_share_is_what_the_page_says(masses):
    (mhe, _), (mpc, _) = masses.mhe_of(0), masses.mpc_of()
    simulator, _ = masses.ready(do_mpc.simulator.Simulator(masses.MODEL))
    parts = {"estimator": mhe, "controller": mpc, "simulator": simulator}
    found = [str(each) for each in shared_objects(parts, run=lambda: mpc.make_step(np.zeros(8)))]
    page = PAGE.read_text("utf-8")
    told = [line for line in found if line.startswith(("Model ", "inertia ", "t_step "))]
    assert len(told) == 3
    assert all(line in page for line in told)
