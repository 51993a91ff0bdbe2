"""motulator's drive, untouched: our loop is its own, and a fault reaches who reads."""

import numpy as np
import pytest

pytest.importorskip("motulator")

from foreign_trials import ROOT, attempted, faulted, imported
from motulator.common.utils import abc2complex

from faultpath import generator
from faultpath.system import shared_objects

EXAMPLE = "motulator_drive.py"
SCENE, STEPS = "seed/3", 240
PARTS = ("reference_gen", "current_ctrl", "observer")


@pytest.fixture
def example(monkeypatch):
    """The example, with short trials in which the torque is ordered early."""
    return imported(monkeypatch, EXAMPLE, STEPS=STEPS, ORDERED_S=0.02)


def held(ctrl):
    """What holds the parameters in each part of their controller."""
    parts = ctrl.vector_ctrl
    holders = parts.reference_gen, parts.current_ctrl, parts.observer.flux_observer
    return dict(zip(PARTS, holders, strict=True))


def own_loop(example, adapts):
    """Run their simulation with their controller; return currents and torque when it measures."""
    ctrl = example.controller(adapts)
    sim, torque = example.simulation(generator("plant/start", SCENE, 0), ctrl)
    for part in held(ctrl).values():
        part.par.psi_f = sim.mdl.machine.par.psi_f
    ctrl.set_torque_ref(lambda t: torque * (t > example.ORDERED_S))
    measured, measure = [], ctrl.get_measurement

    def note(mdl):
        found = measure(mdl)
        measured.append((found.i_c_ab, mdl.machine.out.tau_M))
        return found

    ctrl.get_measurement = note
    sim.simulate(t_stop=STEPS * example.T_S)
    return np.array(measured[:STEPS]).T


@pytest.mark.parametrize("variant", ["fixed", "adapted"])
def test_without_a_fault_our_loop_is_theirs_bit_for_bit(example, monkeypatch, variant) -> None:
    episodes = []
    monkeypatch.setattr(example, "error_percent", lambda episode: episodes.append(episode) or 0.0)
    attempted(example.create(), variant, (SCENE, "seed/4"))
    currents, torque = own_loop(example, variant == "adapted")
    assert np.ptp(torque) > 5
    assert np.array_equal(torque, episodes[0]["torque"][:STEPS])
    assert np.array_equal(currents, [abc2complex(row) for row in episodes[0]["currents"][:STEPS]])


@pytest.mark.parametrize("struck", PARTS)
def test_a_fault_at_one_part_changes_what_that_part_reads(example, monkeypatch, struck) -> None:
    reads, drive = [], example.drive

    def noted(made, currents, dc_voltage, torque_ref):
        reads.append({at: part.par.psi_f for at, part in held(made).items()})
        return drive(made, currents, dc_voltage, torque_ref)

    monkeypatch.setattr(example, "drive", noted)
    system = example.create()
    reads.clear()  # of the steps in which shapes are found
    trial = attempted(system, "fixed", (SCENE,), f"psi_f:scale=1.11@{struck}")
    flux = example.simulation(generator("plant/start", SCENE, 0), None)[0].mdl.machine.par.psi_f
    at_fault = {at: flux * (1.11 if at == struck else 1.0) for at in PARTS}
    assert reads == [at_fault] * STEPS
    assert set(faulted(trial)) == {f"{struck}.psi_f"}


def test_what_its_parts_share_is_found(example) -> None:
    ctrl = example.controller(adapts=True)
    sim, torque = example.simulation(generator("plant/start", SCENE, 0), ctrl)
    ctrl.set_torque_ref(torque)
    parts = {name: getattr(ctrl.vector_ctrl, name) for name in PARTS}
    found = shared_objects(parts, run=lambda: sim.simulate(t_stop=0.2))
    said = (ROOT / "docs" / "motulator.md").read_text("utf-8")
    assert "\n".join(map(str, found)) in said
