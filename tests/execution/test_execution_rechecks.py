"""A little is flown twice: what does not repeat, depends on its block or writes is named."""

import itertools
import json
import re
from dataclasses import replace

import pytest
import torch
from toy_study import SCENES, UNITS, study
from toy_system import CONSUMERS, STEPS, ToySystem

from faultpath.execution import run_study
from faultpath.taps import Reading

_CALLS = itertools.count()


class Odd(ToySystem):
    """Has one oddity, by option."""

    def run(self, variant, scenes, taps, seed):
        outcomes = super().run(variant, scenes, taps, seed)
        match self._options["odd"]:
            case "drifts":
                by = 1e-3 * next(_CALLS)
                return [
                    replace(o, terminal_distance_m=o.terminal_distance_m + by) for o in outcomes
                ]
            case "crowded":
                return [replace(o, time_s=o.time_s * len(scenes)) for o in outcomes]
            case "hashless":
                same = dict.fromkeys(("initial_hash", "disturbance_hash"), "none")
                return [replace(o, **same) for o in outcomes]
        return outcomes


class Scribbler(ToySystem):
    """Reads a tensor once more, and writes into it or not."""

    def run(self, variant, scenes, taps, seed):
        outcomes = super().run(variant, scenes, taps, seed)
        mass = Reading(torch.ones(len(scenes)), "mass", STEPS)
        got = taps.deliver("mass", CONSUMERS[0], mass, STEPS)
        if self._options["odd"] == "writes":
            got *= 2.0
        return outcomes


def odd(**options: str) -> Odd:
    return Odd(**options)


def scribbler(**options: str) -> Scribbler:
    return Scribbler(**options)


def _study(kind: str, factory: str = "odd", rows: slice = slice(1), **options: str):
    asked = study(odd=kind, **options)
    system = asked.system.model_copy(update={"name": f"{__file__}:{factory}"})
    return asked.model_copy(update={"system": system, "rows": asked.rows[rows]})


@pytest.mark.parametrize("workers", [0, 1])
@pytest.mark.parametrize(
    ("kind", "factory", "said"),
    [
        ("drifts", "odd", r"Results do not repeat: 'plain' under correct inputs, seed 0, flown "),
        ("crowded", "odd", r"Results depend on the block: scene 's\d\d' of 'plain' .*time_s by up"),
        ("writes", "scribbler", r"A consumer writes .*tap mass -> planner.thrust: the consumer"),
        ("hashless", "odd", r"All 10 scenes carry the same hashes of initial state"),
    ],
)
def test_an_oddity_is_named_told_and_kept(tmp_path, kind, factory, said, workers):
    told: list[str] = []
    asked = _study(kind, factory)
    if kind == "hashless":
        asked = asked.model_copy(update={"scenes": SCENES})
    result = run_study(asked, tmp_path, workers=workers, notice=told.append)
    found = [finding for finding in result.findings if re.search(said, finding)]
    assert len(found) == 1, result.findings
    assert found[0] in told
    again = run_study(asked, tmp_path, workers=0, notice=told.append)
    assert again.blocks_computed == 0
    assert again.findings == result.findings
    held = json.loads((tmp_path / "deliveries.json").read_text())
    assert found[0] in held["findings"]


def test_a_sound_system_has_none_and_pays_for_three_flights_once(tmp_path):
    log = tmp_path / "log"
    asked = study(log=str(log))
    result = run_study(asked, tmp_path / "run", workers=0)
    assert result.findings == ()
    assert len(log.read_text().splitlines()) == UNITS + 3
    run_study(asked, tmp_path / "run", workers=0)
    assert len(log.read_text().splitlines()) == UNITS + 3
    bare = run_study(study(), tmp_path / "bare", workers=0, recheck=False)
    assert bare.outcomes_sha256 == result.outcomes_sha256
    assert not (tmp_path / "bare" / "rechecks.json").exists()


def test_one_that_leaves_its_reading_alone_is_not_accused(tmp_path):
    assert run_study(_study("reads", "scribbler"), tmp_path, workers=0).findings == ()


def test_a_consumer_that_never_reads_is_named(tmp_path):
    row = study().rows[0]
    deaf = row.model_copy(
        update={"variant": "deaf", "arm": row.arm.model_copy(update={"variant": "deaf"})}
    )
    asked = study().model_copy(update={"rows": (row, deaf)})
    told: list[str] = []
    (finding,) = run_study(asked, tmp_path, workers=0, notice=told.append).findings
    assert finding.startswith("Variant 'deaf' declares that observer.balance reads 'mass', but it")
    assert finding in told


def test_failed_trials_are_not_drawn(tmp_path):
    result = run_study(study(raises="s05"), tmp_path, workers=0)
    assert result.findings == ()
