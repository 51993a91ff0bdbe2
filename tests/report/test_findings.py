"""What was found in trials is stored as data, and said from that."""

import pytest
from pydantic import TypeAdapter

from faultpath.report.sentences.findings import describe
from faultpath.run.findings import (
    Deviation,
    ExtraTrials,
    Finding,
    MissingTrials,
    NoneFailed,
    RaisedTogether,
    Recheck,
    SeveralTasks,
    Unpaired,
    Unproven,
    Unread,
    Unrecorded,
    Unrepeated,
)

OTHERWISE = Deviation(scenes=("s1", "s4"), of=4, ended=1, gaps=(("time_s", 0.25), ("note", None)))
COUNTED = Deviation(scenes=("s1",), of=1, gaps=(("faulted_steps", 9.0),))
AGAIN = {"unit": "key", "variant": "old", "faults": "gain scaled by 0.5", "seed": 3}
FINDINGS = (
    (
        Recheck(why="sample", scenes=("s1", "s2", "s3", "s4"), unit_scenes=20, **AGAIN).model_copy(
            update={"deviation": OTHERWISE}
        ),
        "Results do not repeat: a second run of 4 scenes of 'old' under gain scaled by 0.5, seed "
        "3, without the other scenes of its block of 20, differs in 2 of 4 scenes, such as 's1' (1 "
        "trial with another end, time_s by up to 0.25, other note). ",
    ),
    (
        Recheck(why="guarded", scenes=("s1",), unit_scenes=20, **AGAIN).model_copy(
            update={"deviation": COUNTED}
        ),
        "Results do not repeat: a second run of 1 scene of 'old' under gain scaled by 0.5, seed 3, "
        "alone, with a copy of every reading for each module, differs (every trial with the same "
        "end, faulted_steps by up to 9). Only what is counted differs: a loop that ends with the ",
    ),
    (
        Recheck(why="guarded", scenes=("s1",), unit_scenes=20, wrote="tap a -> b.c", **AGAIN),
        "A module writes into its reading, seen with 'old' under gain scaled by 0.5, seed 3: tap a "
        "-> b.c. ",
    ),
    (
        Unpaired(
            first=("new", "shared"),
            second=("old", "shared"),
            scene="s1",
            seed=3,
            differences=(("initial_hash", "0123456789", "abc"),),
            others=2,
        ),
        "new under shared and old under shared are no pair in scene 's1' (seed 3): their initial "
        "states differ (initial_hash '01234567' and 'abc'); so do those of 2 other pairs.",
    ),
    (Unproven(scenes=9, hashes=("", "")), "All 9 scenes carry the same hashes of initial state"),
    (
        Unread(variant="old", channel="gain", reader="a.b"),
        "Variant 'old' declares that a.b reads 'gain', but it never did: ",
    ),
    (
        RaisedTogether(blocks=2, of=8, error="ValueError: no"),
        "2 of 8 blocks raised an error when their scenes ran together, and none when each ran "
        "alone: ValueError: no. ",
    ),
    (Unrecorded(error="no room."), "No signals were recorded: no room."),
    (
        Unrepeated(
            trials=2,
            of=16,
            variant="old",
            condition="shared",
            scene="s1",
            deviation=Deviation(raised="no", scenes=("s1",), of=1),
        ),
        "2 of 16 trials came out otherwise when they ran again to record signals, which are not "
        "kept: the first, old, shared, s1, failed the second time (no), which differs.",
    ),
    (
        MissingTrials(
            variant="new", condition="shared", trials=1, unit="scene", first="s1", trial="3"
        ),
        "Under the shared fault, 1 trial of new is missing, for example that in s1 (seed 3): "
        "pairs that lack a trial do not count.",
    ),
    (
        MissingTrials(
            variant="new", condition="shared", trials=2, unit="task", first="t1", trial="s1, seed 3"
        ),
        "Under the shared fault, 2 trials of new are missing, for example that in t1 (s1, seed 3)",
    ),
    (
        ExtraTrials(units=2, unit="task", first="t1"),
        "2 tasks have more trials than the others, for example t1: the extra trials are left out.",
    ),
    (SeveralTasks(tasks=3), "The scenes come from 3 tasks and are taken as independent: "),
    (NoneFailed(), "No trial ended without success, and some say nothing: "),
)


@pytest.mark.parametrize(("finding", "words"), FINDINGS)
def test_a_finding_is_said_from_its_data_alone(finding: Finding, words: str) -> None:
    stored: TypeAdapter[Finding] = TypeAdapter(Finding)
    held = stored.validate_json(stored.dump_json(finding))
    assert held == finding
    assert describe(held).startswith(words)
    assert len({finding, held}) == 1  # results decided anew hold each once


def test_every_kind_has_words() -> None:
    kinds = TypeAdapter(Finding).json_schema()["discriminator"]["mapping"]
    assert set(kinds) == {finding.kind for finding, _ in FINDINGS}
