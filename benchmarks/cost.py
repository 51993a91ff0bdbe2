"""What faultpath adds to trials, beside a bare loop, and what it takes for very many of them."""

import csv
from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

import faultpath
from benchmarks import two_link
from benchmarks.many_scenes import SUCCESS
from benchmarks.results import ROOT, TAPS
from benchmarks.side import Side, check_same
from faultpath.analyses.model import CORRECT, SHARED
from faultpath.core.files.parquet import read_table
from faultpath.core.streams import generator
from faultpath.faults import resolve
from faultpath.loop import Taps

SCENES, FACTOR, SCENE = 20, 0.5, "seed/1000"
JUDGED, AUDITED = 10_000, 10_000
"""Scenes of the trials that are judged, and of the toy."""
_PAYLOADS = (
    (1.0, 1.0),
    (1.0, FACTOR),
    (FACTOR, 1.0),
    (FACTOR, FACTOR),
    (None, 1.0),
    (None, FACTOR),
)
"""Payload of observer and controller in each treatment of the audit; see `two_link.bare`."""
_LIBRARY = 'tuple(SceneRef(f"cart/{i:03d}", i) for i in range(100))'


def one_scene() -> Side:
    """One scene of the arm, in a block of its own, under the shared fault; the unit is a step."""
    return Side(_one_scene, two_link.STEPS)


def bare_scene() -> Side:
    """The same trial in a bare loop."""
    check_same(_one_scene(), two_link.bare(SCENE, FACTOR, FACTOR), 1e-9)
    return Side(lambda: two_link.bare(SCENE, FACTOR, FACTOR), two_link.STEPS)


_SYSTEM = two_link.create()


def _one_scene() -> float:
    variant = _SYSTEM.variants["calibrated"]
    faults = resolve(_SYSTEM.fault(f"payload:scale={FACTOR}"), _SYSTEM.interface)
    taps = Taps(
        _SYSTEM.interface,
        faults,
        scenes=(SCENE,),
        dt_s=_SYSTEM.control_dt_s,
        bindings=variant.bindings,
        readers=variant.readers,
    )
    (outcome,) = _SYSTEM.run(variant.name, [SCENE], taps, 0)
    if len(taps.delivery_log().taps) != TAPS:
        raise RuntimeError(f"the arm has {len(taps.delivery_log().taps)} taps: correct TAPS")
    missed_rad = outcome.metrics["missed_rad"]
    assert missed_rad is not None
    return missed_rad


def arm_audit() -> Side:
    """An audit of the arm in one process, with its report; the unit is a trial."""
    return Side(_audited, SCENES * len(_PAYLOADS))


def bare_trials() -> Side:
    """The trials of that audit in a bare loop."""
    scenes = [scene.id for scene in _SYSTEM.library("held-out").scenes[:SCENES]]

    def work() -> list[list[float]]:
        return [[two_link.bare(scene, *payloads) for scene in scenes] for payloads in _PAYLOADS]

    check_same(sorted(work()), sorted(_audited()), 1e-6)
    return Side(work, SCENES * len(_PAYLOADS))


def _audited() -> list[list[float]]:
    """Audit the arm, and return how far from its goal it ended, by treatment and scene."""
    outcomes = _run(
        faultpath.audit,
        ROOT / "benchmarks" / "two_link.py",
        baseline="calibrated",
        repair="nominal",
        fault=f"payload:scale={FACTOR}",
        scenes=SCENES,
        workers=0,
    )
    missed: Any = read_table(outcomes).column("missed_rad")
    treatments = missed.to_numpy().reshape(-1, SCENES)
    return np.unique(treatments.round(9), axis=0).tolist()


def _run(call: Callable[..., object], place: Path, **question: Any) -> bytes:
    """Write a run into a new folder, and return the table of its outcomes."""
    with TemporaryDirectory() as name:
        folder = Path(name) / "run"
        call(place, folder=folder, progress=False, **question)
        return (folder / "outcomes.parquet").read_bytes()


def judged(scenes: int = JUDGED) -> Side:
    """`judge` of a CSV file with a row a trial: two versions, four conditions; with its report."""
    folder = TemporaryDirectory()
    results, draws = Path(folder.name) / "results.csv", generator("benchmark-judge", "all", 0)
    conditions = {CORRECT: CORRECT, "observer": "observer", "controller": "observer"}
    with results.open("w", encoding="utf-8") as file:
        rows = csv.writer(file)
        rows.writerow(("variant", "condition", "scene", "success"))
        for condition, alike in (conditions | {SHARED: SHARED}).items():
            for variant, rate in zip(("repair", "baseline"), SUCCESS[alike], strict=True):
                ends = draws.random(scenes) < rate
                rows.writerows((variant, condition, i, int(end)) for i, end in enumerate(ends))

    def work() -> None:
        file = Path(folder.name) / "results.csv"
        _run(faultpath.judge, file, baseline="baseline", repair="repair", nominal=CORRECT)

    return Side(work)


def many_scenes() -> Side:
    """An audit of the toy in very many scenes, in one process, with its report."""
    text = (ROOT / "examples" / "toy.py").read_text("utf-8")
    if _LIBRARY not in text:
        raise RuntimeError("examples/toy.py makes its library otherwise: correct _LIBRARY")
    folder = TemporaryDirectory()
    system = Path(folder.name) / "toy.py"
    system.write_text(text.replace(_LIBRARY, _LIBRARY.replace("100", str(AUDITED))), "utf-8")

    question = {"baseline": "calibrated", "repair": "blind", "fault": "gain:scale=0.6"}

    def work() -> None:
        file = Path(folder.name) / "toy.py"
        _run(faultpath.audit, file, library="carts", workers=0, **question)

    return Side(work)
