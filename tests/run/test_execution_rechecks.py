"""A little is flown twice: what does not repeat, depends on its block or writes is named."""

import itertools
import re
import time
from dataclasses import replace

import numpy as np
import pytest
from toy_plan import SCENES, UNITS, plan, plan_of
from weighed import READERS, ToySystem

from faultpath.core.errors import Stopped
from faultpath.loop import Reading
from faultpath.report.sentences.findings import describe
from faultpath.run.deliveries import Deliveries, unproven
from faultpath.run.execution.recheck import SAMPLE, Rechecks
from faultpath.run.execution.runner import run_plan
from faultpath.run.work.executor import Lost

_CALLS = itertools.count()


class Odd(ToySystem):
    """Has one oddity, by option; `block` is the size of a block."""

    def __init__(self, **options: str) -> None:
        super().__init__(**options)
        self.block_size = int(options.get("block", "4"))
        self._random = np.random.default_rng(0)
        self._calls: dict[tuple[str, ...], int] = {}

    def run(self, variant, scenes, taps, seed):
        outcomes = super().run(variant, scenes, taps, seed)
        match self._options["odd"]:
            case "drifts":
                return _moved(outcomes, [1e-3 * next(_CALLS)] * len(scenes))
            case "clock":
                return _moved(outcomes, [1e-9 * (time.perf_counter_ns() % 10**9)] * len(scenes))
            case "random":  # one generator for all that a process flies
                return _moved(outcomes, self._random.normal(size=len(scenes)))
            case "cache":  # what is made for some scenes is written to at each flight of them
                self._calls[tuple(scenes)] = calls = self._calls.get(tuple(scenes), 0) + 1
                return _moved(outcomes, [0.1 * calls] * len(scenes))
            case "by-place":  # the same numbers at each call, in the order of its scenes
                return _moved(outcomes, np.random.default_rng(seed).normal(size=len(scenes)))
            case "crowded":
                return [replace(o, time_s=o.time_s * len(scenes)) for o in outcomes]
            case "hashless":
                same = dict.fromkeys(("initial_hash", "disturbance_hash"), "none")
                return [replace(o, **same) for o in outcomes]
            case "reads" | "writes" | "plant writes" as kind:
                import torch

                state = torch.ones(len(scenes))
                got = taps.deliver(
                    "mass", READERS[0], Reading(state, "mass", ToySystem.steps), ToySystem.steps
                )
                if kind == "writes":
                    got *= 2.0
                if kind == "plant writes":  # into what it has delivered, and the reader has kept
                    state += 1.0
                    return _moved(outcomes, got)
        return outcomes


def _moved(outcomes, by):
    return [
        replace(o, metrics={"distance": o.metrics["distance"] + abs(float(by[i]))})
        for i, o in enumerate(outcomes)
    ]


def odd(**options: str) -> Odd:
    return Odd(**options)


def _plan(kind: str, count: int = 1, **options: str):
    if kind in ("reads", "writes", "plant writes"):
        pytest.importorskip("torch")
    return plan_of(f"{__file__}:odd", count=count, odd=kind, **options)


@pytest.mark.parametrize(
    ("kind", "words"),
    [
        ("drifts", r"Results do not repeat: .* of 'plain' under correct inputs, seed 0"),
        ("crowded", r"Results do not repeat: .* of 'plain' .*time_s by up"),
        (
            "plant writes",
            r"Results do not repeat: .* 1 scene of 'plain' .* a copy of every reading",
        ),
        ("writes", r"A module writes .*tap mass -> planner.thrust: the reader"),
        ("hashless", r"All 10 scenes carry the same hashes of initial state"),
    ],
)
def test_an_oddity_is_named_and_kept(tmp_path, kind, words):
    trials = _plan(kind)
    result = run_plan(trials, tmp_path, workers=int(kind == "writes"))
    found = [finding for finding in result.findings if re.search(words, describe(finding))]
    assert found, result.findings
    again = run_plan(trials, tmp_path, workers=0)
    assert again.blocks_computed == 0
    assert again.findings == result.findings
    held = Deliveries.model_validate_json((tmp_path / "deliveries.json").read_bytes())
    assert found[0] in held.findings


@pytest.mark.parametrize(
    ("kind", "block"),
    [("clock", "4"), ("random", "10"), ("cache", "10"), ("by-place", "4"), ("by-place", "10")],
)
def test_what_does_not_repeat_is_seen_whatever_the_reason(tmp_path, kind, block):
    findings = run_plan(_plan(kind, count=12, block=block), tmp_path, workers=0).findings
    assert findings
    assert all(describe(finding).startswith("Results do not repeat: ") for finding in findings)


@pytest.mark.parametrize("kind", ["", "crowded"])
def test_a_run_killed_between_second_runs_ends_with_the_same_tables(tmp_path, kind, monkeypatch):
    trials = _plan(kind, count=12, block="10")
    whole = run_plan(trials, tmp_path / "whole", workers=0)
    assert len(whole.rechecks) == 2
    for flights in range(2):
        folder = tmp_path / str(flights)
        with monkeypatch.context() as patched:
            patched.setattr(Rechecks, "handle_reply", _stopping(flights))
            with pytest.raises(Stopped):
                run_plan(trials, folder, workers=0)
        result = run_plan(trials, folder, workers=0)
        assert result.rechecks == whole.rechecks
        for name in ("outcomes.parquet", "deliveries.json", "rechecks.json"):
            assert (folder / name).read_bytes() == (tmp_path / "whole" / name).read_bytes()


def test_a_second_run_whose_worker_died_is_tried_again(tmp_path, monkeypatch):
    handle_reply = Rechecks.handle_reply
    with monkeypatch.context() as patched:
        died = Lost("it was killed")
        patched.setattr(Rechecks, "handle_reply", lambda *at: handle_reply(*at[:2], died))
        first = run_plan(plan(), tmp_path, workers=0)
    assert all("could not be run again (it was killed)" in describe(f) for f in first.findings)
    again = run_plan(plan(), tmp_path, workers=0)
    assert (len(first.findings), len(again.rechecks), again.findings) == (2, 2, ())


def _stopping(after: int):
    handle_reply, flights = Rechecks.handle_reply, itertools.count()

    def stopping(self, *arguments):
        if next(flights) == after:
            raise KeyboardInterrupt
        handle_reply(self, *arguments)

    return stopping


def test_a_few_scenes_of_a_later_treatment_run_at_other_places_than_before(tmp_path):
    result = run_plan(_plan("", count=12, block="10"), tmp_path, workers=0)
    assert [each.why for each in result.rechecks].count("sample") == 1
    few = next(each for each in result.rechecks if each.why == "sample")
    (one,) = (each for each in result.rechecks if each is not few)
    assert (one.why, len(one.scenes), one.unit != few.unit) == ("guarded", 1, True)
    assert (len(few.scenes), few.unit_scenes, few.deviation) == (SAMPLE, 10, None)
    assert all(SCENES.index(scene) > i for i, scene in enumerate(few.scenes))
    first = plan().rows[0].treatment
    assert (few.variant, few.faults, few.seed) != (first.variant, "correct inputs", first.seed)


def test_a_sound_system_has_none_and_pays_for_two_flights_once(tmp_path):
    log = tmp_path / "log"
    asked = plan(log=str(log))
    result = run_plan(asked, tmp_path / "run", workers=0)
    assert result.findings == ()
    assert len(log.read_text().splitlines()) == UNITS + 2
    run_plan(asked, tmp_path / "run", workers=0)
    assert len(log.read_text().splitlines()) == UNITS + 2
    bare = run_plan(plan(), tmp_path / "bare", workers=0, recheck=False)
    assert bare.outcomes_sha256 == result.outcomes_sha256
    assert not (tmp_path / "bare" / "rechecks.json").exists()


def test_one_that_leaves_its_reading_alone_is_not_accused(tmp_path):
    assert run_plan(_plan("reads"), tmp_path, workers=0).findings == ()


def test_a_reader_that_never_reads_is_named(tmp_path):
    row = plan().rows[0]
    deaf = row.model_copy(
        update={
            "variant": "deaf",
            "treatment": row.treatment.model_copy(update={"variant": "deaf"}),
        }
    )
    asked = plan().model_copy(update={"rows": (row, deaf)})
    (finding,) = run_plan(asked, tmp_path, workers=0).findings
    assert describe(finding).startswith(
        "Variant 'deaf' declares that observer.balance reads 'mass', but it"
    )


def test_hashes_are_compared_until_two_differ():
    def met():
        yield from (("s0", ("i", "d", "n")), ("s0", ("i", "d", "n")), ("s1", ("i", "d", "m")))
        raise AssertionError

    assert unproven(met()) == ()
    assert unproven([("s0", ("i", "d", "n"))] * 2) == ()
    assert unproven((scene, ("i", "d", "n")) for scene in SCENES)[0].scenes == len(SCENES)


def test_failed_trials_are_not_drawn(tmp_path):
    result = run_plan(plan(raises="s05"), tmp_path, workers=0)
    assert result.findings == ()
