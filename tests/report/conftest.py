"""A synthetic audit that looks like a real one: the paper's reversal, made from a seeded law.

The repair is a reconstruction trained with uncertainty: ahead when only the reconstruction is
faulted, behind when the fault is shared. Names a user may give carry markup, to see it escaped.
"""

import os
import shutil
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from functools import cache
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pytest
from outcomes import outcome

from faultpath.analyses.decide import decide
from faultpath.analyses.facts import ComparisonFacts
from faultpath.analyses.model import Condition, FaultedTap
from faultpath.faults import FaultText
from faultpath.interface import Interface, read_interface
from faultpath.report.inputs import ReportInput
from faultpath.run.provenance import RunProvenance
from faultpath.run.question import AuditQuestion
from faultpath.run.shown import SystemShown, VariantShown
from faultpath.run.trials import Trial, Trials
from faultpath.system import Outcome, Status
from faultpath.system.declared import FloorPlan, Pillar, Prism

if TYPE_CHECKING:
    from playwright.sync_api import Browser

TOPOLOGIES = ("clutter", "corridors", "doorways", "intersections", "rooms")
BASELINE, REPAIR = "gru", "gru-dcc"
ARGUMENTS = [
    *("--no-sandbox", "--disable-gpu", "--no-first-run", "--disable-background-networking"),
    *("--disable-component-update", "--disable-sync"),
]
ROOT = Path(__file__).resolve().parents[2]
HASH = "9d0c31f2" * 8
NASTY = '<script>alert("x")</script> & 100 % of _it_'

# Chance of success by condition: (baseline, repair). They share one draw, so pairs are correlated.
CHANCES = {
    "correct": (0.69, 0.60),
    "predictor": (0.30, 0.33),
    "reconstruction": (0.46, 0.63),
    "shared": (0.69, 0.48),
}

INTERFACE = """
name: quadrotor
sources:
- {name: mass_estimate, unit: kg, provenance: estimated, correlation_group: calibration}
- {name: thrust_scale_estimate, unit: '1', provenance: estimated, correlation_group: calibration}
- {name: position_estimate, unit: m, shape: [3], provenance: estimated}
- {name: velocity_estimate, unit: m/s, shape: [3], provenance: estimated, latency_s: 0.02}
- {name: zero_wind, unit: m/s, shape: [3], provenance: constant}
- {name: reconstructed_wind, unit: m/s, shape: [3], provenance: reconstructed}
channels:
- {name: mass, sources: [mass_estimate], gap: fidelity,
   readers: [predictor.dynamics, predictor.wind_map, predictor.trim, reconstruction.head]}
- {name: thrust_scale, sources: [thrust_scale_estimate], gap: fidelity,
   readers: [predictor.dynamics, predictor.trim, reconstruction.head]}
- {name: position, sources: [position_estimate], gap: fidelity,
   readers: [predictor.initial_state]}
- {name: velocity, sources: [velocity_estimate], gap: fidelity,
   readers: [predictor.initial_state, reconstruction.history]}
- {name: wind, sources: [zero_wind, reconstructed_wind], gap: availability,
   readers: [predictor.wind_map]}
reconstructs: {reconstruction: reconstructed_wind}
"""


def make_input(
    seeds: tuple[int, ...] = (0,),
    n_scenes: int = 80,
    void: bool = True,
    library: str = "held-out " + NASTY,
    lost: str = "",
    chances: Mapping[str, tuple[float, float]] = CHANCES,
) -> ReportInput:
    """Build the audit; everything follows from the arguments. `lost`: every trial there failed."""
    conditions = _conditions()
    rows = tuple(
        _lose(row) if row.condition == lost else row
        for row in _rows(seeds, n_scenes, void, chances)
    )
    question = AuditQuestion(
        options={"wind": "L3", "predictor": "wm-a"},
        baseline=BASELINE,
        repair=REPAIR,
        fault=FaultText.read("calibration=+0.1"),
    )
    facts = ComparisonFacts(
        system="quadrotor",
        library=library,
        library_hash=HASH,
        n_scenes=n_scenes,
        seeds=seeds,
    )
    outcomes = Trials.of(rows)
    record = decide(question, facts, conditions, outcomes)
    return ReportInput(
        record=record,
        provenance=_provenance(),
        system=SystemShown(
            control_dt_s=0.05,
            interface=interface(),
            variants=(_variant(BASELINE), _variant(REPAIR)),
            plans={_scene(i): _plan(i) for i in range(n_scenes)},
        ),
        trials=outcomes,
    )


def _lose(row: Trial) -> Trial:
    return replace(row, outcome=replace(row.outcome, status=Status.FAILED, error="no number"))


@cache
def interface() -> Interface:
    return read_interface(INTERFACE)


@pytest.fixture(scope="session")
def browser() -> Iterator["Browser"]:
    """A Chromium without a network; skipped only where there is none and `CI` is not set."""
    chromium = shutil.which("chromium") or shutil.which("chromium-browser")
    if chromium is None:
        if os.environ.get("CI"):
            pytest.fail("there is no Chromium, and CI must run the browser tests")
        pytest.skip("there is no Chromium on this machine")
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        running = playwright.chromium.launch(executable_path=chromium, args=ARGUMENTS)
        yield running
        running.close()


@pytest.fixture(scope="session")
def make() -> Callable[..., ReportInput]:
    return make_input


@pytest.fixture(scope="session")
def one_seed() -> ReportInput:
    return make_input()


@pytest.fixture(scope="session")
def three_seeds() -> ReportInput:
    return make_input(seeds=(0, 1, 2))


def _variant(name: str) -> VariantShown:
    return VariantShown(
        name=name,
        readers=tuple(sorted({c for channel in interface().channels for c in channel.readers})),
        bindings={"wind": "reconstructed_wind"},
    )


def _faulted(*readers: str) -> tuple[FaultedTap, ...]:
    """Return the taps of a fault on the calibration at these readers, as in a delivery log."""
    return tuple(
        FaultedTap(channel=channel.name, reader=reader, faulted_steps=9, altered_steps=9)
        for channel in interface().channels
        if channel.name in ("mass", "thrust_scale")
        for reader in channel.readers
        if reader in readers
    )


def _conditions() -> tuple[Condition, ...]:
    predictor = ("predictor.dynamics", "predictor.wind_map", "predictor.trim")
    head = ("reconstruction.head",)
    return (
        _condition("correct", "Correct inputs", ()),
        _condition("predictor", "Predictor only", predictor),
        _condition("reconstruction", "Reconstruction only", head),
        _condition("shared", "Shared fault", (*predictor, *head)),
    )


def _condition(name: str, title: str, readers: tuple[str, ...]) -> Condition:
    faulted = _faulted(*readers)
    return Condition(
        name=name,
        title=title,
        readers=readers,
        baseline_readers=readers,
        faulted=faulted,
        baseline_faulted=faulted,
    )


def _scene(index: int) -> str:
    return f"{TOPOLOGIES[index % 5]}-{index:03d}"


def _rows(
    seeds: tuple[int, ...], n_scenes: int, void: bool, law: Mapping[str, tuple[float, float]]
) -> Iterator[Trial]:
    for seed, index in product(seeds, range(n_scenes)):
        rng = np.random.default_rng([seed, index])
        hard = 0.8 * np.random.default_rng([99, index]).random() + 0.2 * rng.random()
        for condition, chances in law.items():
            for variant, chance in zip((BASELINE, REPAIR), chances, strict=True):
                at = (seed, index, condition, variant)
                failed = void and at == (seeds[0], 17, "shared", REPAIR)
                solved = hard + 0.11 * rng.standard_normal() < chance
                ended = _outcome(index, seed, solved, failed, condition != "correct", rng)
                yield Trial(variant, condition, seed, index, TOPOLOGIES[index % 5], ended)


def _outcome(
    index: int, seed: int, solved: bool, failed: bool, faulted: bool, rng: np.random.Generator
) -> Outcome:
    if failed:
        error = "RuntimeError: <b>no</b> candidate is finite"
        return outcome(_scene(index), Status.FAILED, seed, error=error)
    crash = rng.random() < 0.7
    status = Status.SUCCESS if solved else Status.CRASH if crash else Status.TIMEOUT
    trace = _track(index, status, rng)
    missed = float(np.linalg.norm(trace[-1] - np.array(_plan(index).goal)))
    clearance = 0.0 if status is Status.CRASH else float(rng.uniform(0.05, 0.6))
    return outcome(
        _scene(index),
        status,
        seed,
        time_s=12.0 if status is Status.TIMEOUT else 0.05 * (len(trace) - 1),
        metrics={"terminal_distance_m": missed, "min_clearance_m": clearance},
        faulted_steps=len(trace) * faulted,
        altered_steps=len(trace) * faulted,
        trace=trace,
    )


def _track(index: int, status: Status, rng: np.random.Generator) -> np.ndarray:
    """Fly from start to goal round the middle; a crash stops on the way, a timeout takes long."""
    plan = _plan(index)
    start, goal = np.array(plan.start), np.array(plan.goal)
    lasts = {Status.SUCCESS: rng.integers(55, 90), Status.CRASH: rng.integers(60, 80)}
    steps = int(lasts.get(status, 240))
    u = np.linspace(0.0, 1.0, steps)[:, None]
    side = np.array([0.0, 1.0, 0.0]) * rng.choice([-1.0, 1.0]) * rng.uniform(0.9, 1.7)
    sink = np.array([0.0, 0.0, 1.0]) * rng.uniform(-0.6, 0.3)
    track = start + u * (goal - start) + np.sin(np.pi * u) * side + np.sin(np.pi * u / 2) * sink
    if status is Status.CRASH:
        track = track[: int(steps * rng.uniform(0.35, 0.8))]
    return track.astype(np.float32)


@cache
def _plan(index: int) -> FloorPlan:
    rng = np.random.default_rng([7, index])
    crates: list[Prism] = []
    for x, y, w, d, top in rng.uniform((1.5, -2.7, 0.3, 0.3, 0.8), (7.5, 2.0, 0.9, 0.9, 3), (6, 5)):
        corners = ((x, y), (x + w, y), (x + w, y + d), (x, y + d))
        crates.append(Prism(tuple((float(a), float(b)) for a, b in corners), 0.0, float(top)))
    at = rng.uniform((1.5, -2.5), (8.0, 2.5), (4, 2))
    return FloorPlan(
        low=(0.0, -3.0, 0.0),
        high=(10.0, 3.0, 3.0),
        prisms=tuple(crates),
        pillars=tuple(Pillar(float(x), float(y), 0.2, 0.0, 3.0) for x, y in at),
        start=(0.8, float(rng.uniform(-1.5, 1.5)), 1.2),
        goal=(9.2, float(rng.uniform(-1.5, 1.5)), 1.4),
        title=TOPOLOGIES[index % 5],
    )


def _provenance() -> RunProvenance:
    stored = ROOT / "docs" / "reference" / "toy" / "provenance.json"
    run = RunProvenance.model_validate_json(stored.read_bytes())
    code = run.code.model_copy(update={"dirty": True, "system_fingerprint": "b7e1" * 16})
    packages = {"numpy": "2.4.6", "torch": "2.13.0"}
    changes = {
        "command": ("faultpath", "audit", "quadrotor", "--library", NASTY),
        "code": code,
        "machine": run.machine.model_copy(update={"python": "3.11.2", "packages": packages}),
        "blocks_kept": 8,
        "library_hash": HASH,
    }
    return run.model_copy(update=changes)
