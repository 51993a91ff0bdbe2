"""The scenes that the viewer begins with: those that go as the audit announced."""

from collections.abc import Mapping
from dataclasses import replace

import pytest
from page_reader import unpack

from faultpath.analyses.model import AuditResult
from faultpath.analyses.pairs import Pair, alike, choose, read_pairs
from faultpath.report.inputs import ReportInput
from faultpath.report.viewer import captions, viewer_data
from faultpath.system import Status

CONDITIONS = ("correct", "predictor", "reconstruction", "shared")
LETTERS = {"b": (True, True), "r": (False, True), "l": (True, False), "n": (False, False)}
"""Who succeeds: both, only the repair, only the baseline, neither."""


def scenes(source: ReportInput, *patterns: str, ends: Mapping[int, Status] = {}) -> list[Pair]:
    """Return the pairs of scenes that went so on the four conditions; `ends` is how failures
    ended."""

    def went(pair: Pair) -> Pair:
        baseline, repair = LETTERS[patterns[pair.index][CONDITIONS.index(pair.condition)]]
        lost = ends.get(pair.index, Status.CRASH)
        trials = ((pair.baseline, baseline), (pair.repair, repair))
        one, two = (
            None if trial is None else replace(trial, status=Status.SUCCESS if won else lost)
            for trial, won in trials
        )
        return replace(pair, baseline=one, repair=two)

    pairs = read_pairs(source.trials, source.record)
    return [went(pair) for pair in pairs if pair.index < len(patterns)]


def announcing(source: ReportInput, **signs: int) -> AuditResult:
    """Return the record as if it announced these signs, and what follows from them."""
    record = source.record
    effects = tuple(
        effect.model_copy(update={"sign": signs.get(effect.condition, 0), "rates": (50.0, 50.0)})
        for effect in record.effects
    )
    changes = tuple(
        change.model_copy(
            update={"turn": turn, "sign": -signs.get(change.isolated, 0) if turn != "none" else 0}
        )
        for change in record.changes
        for alone, shared in [(signs.get(change.isolated, 0), signs.get("shared", 0))]
        for turn in ["reversal" if alone * shared < 0 else "interaction" if alone else "none"]
    )
    return record.model_copy(update={"effects": effects, "changes": changes})


def begun(
    source: ReportInput, record: AuditResult, pairs: list[Pair], recorded: tuple[int, ...] = ()
) -> list[int]:
    """Return the scenes that the viewer begins with, by their index; `recorded` are those of which
    signals were."""
    places = {(pair.scene, pair.seed): pair.index for pair in pairs}
    kept = [at for at, place in places.items() if place in recorded]
    return [places[at] for at in choose(record, pairs, kept)]


def timed(pairs: list[Pair], *times: float) -> list[Pair]:
    """Return the pairs with the time at which each scene's first trial ends; the other goes on."""
    return [
        replace(
            pair,
            baseline=pair.baseline and replace(pair.baseline, time_s=times[pair.index]),
            repair=pair.repair and replace(pair.repair, time_s=times[pair.index] + 5.0),
        )
        for pair in pairs
    ]


@pytest.mark.parametrize("unknown", ["baseline", "repair"])
def test_a_time_that_one_version_lacks_is_that_of_the_other(one_seed, unknown):
    pairs = timed(scenes(one_seed, *["rrrr"] * 3), 2.0, 4.0, 9.0)
    without = [
        replace(pair, **{unknown: replace(getattr(pair, unknown), time_s=float("nan"))})
        for pair in pairs
    ]
    assert alike(without) == alike(pairs)
    assert [typical for _, typical in alike(pairs).values()] == [False, True, False]


@pytest.mark.parametrize(
    ("signs", "patterns", "first"),
    [
        ({"reconstruction": 1}, "nnrn lnnb bblb bbbb bbrb rbrl bbrb brrb", 4),
        (
            {"reconstruction": 1, "shared": -1, "correct": -1},
            "lbbl lbbl bbrb bbrl nnrl lbrr bbbl",
            3,
        ),
    ],
)
def test_what_is_significant_is_shown_by_a_scene_that_goes_so(
    one_seed: ReportInput, signs: dict[str, int], patterns: str, first: int
) -> None:
    """An isolated win by one in which only that variant survives there, a reversal by one that has
    both sides."""
    record, pairs = announcing(one_seed, **signs), scenes(one_seed, *patterns.split())
    assert begun(one_seed, record, pairs)[0] == first


def test_of_scenes_that_go_alike_the_median_one_is_shown_and_stays_shown(
    one_seed: ReportInput,
) -> None:
    record = announcing(one_seed, reconstruction=1)
    pairs = timed(scenes(one_seed, "bbrb", "bbrb", "bbrb", "bbrb", "bbrb"), 9.0, 1.0, 4.0, 3.0, 8.0)
    assert begun(one_seed, record, pairs)[0] == 2
    said = {pair.index: captions(pairs)[pair.scene, 0] for pair in pairs}
    assert [place for place in said if "It is a typical one" in said[place]] == [2]
    assert begun(one_seed, record, pairs, recorded=(1,))[0] == 1
    other = scenes(one_seed, "bbrb", "bbbb", "bbrb")
    assert begun(one_seed, record, other, recorded=(1,))[-1] == 1, "it goes otherwise"
    untimed = timed(pairs, *[float("nan")] * 5)
    assert begun(one_seed, record, untimed)[0] == 0
    assert not any("typical" in words for words in captions(untimed).values())


@pytest.mark.parametrize(
    ("signs", "condition"),
    [({"reconstruction": 1}, "reconstruction"), ({"reconstruction": 1, "shared": -1}, "shared")],
)
def test_the_condition_that_is_shown_first_was_announced(
    one_seed: ReportInput, signs: dict[str, int], condition: str
) -> None:
    record, pairs = announcing(one_seed, **signs), scenes(one_seed, "bbrb", "bbrl", "bbbb")
    viewer = viewer_data(replace(one_seed, record=record), pairs)
    assert viewer is not None
    assert unpack(viewer.packed)[0]["condition"] == condition


@pytest.mark.parametrize("sign", [0, 1])
def test_what_is_decided_at_the_floor_announces_nothing(one_seed: ReportInput, sign: int) -> None:
    """Nothing announced: first scenes in which trials end apart, then what most scenes do."""
    record = announcing(one_seed, reconstruction=sign)
    floor = tuple(e.model_copy(update={"rates": (5.0, 6.0)}) for e in record.effects)
    quiet = tuple(c.model_copy(update={"turn": "none"}) for c in record.changes)
    record = record.model_copy(update={"effects": floor, "changes": quiet})
    pairs = timed(scenes(one_seed, "rrrr", "bbrb", "nnnn", "bbbb", "nnnn", "bbbb"), *[9.0] * 6)
    assert begun(one_seed, record, pairs) == [0, 1, 2, 3, 4, 5]
    counts = sorted(said.partition(":")[0] for said in captions(pairs).values())
    assert counts == [
        f"{n} of 6 scenes go{'es' * (n == 1)} like this one" for n in (1, 1, 2, 2, 2, 2)
    ]


def test_void_scenes_are_neither_shown_nor_counted(one_seed: ReportInput) -> None:
    pairs = scenes(one_seed, "bbrb", "bbrb", "bbbb", "bbbb")
    dead = next(p for p in pairs if p.index == 0 and p.condition == "shared")
    assert dead.repair is not None
    died = replace(dead, repair=replace(dead.repair, status=Status.FAILED, error="no number"))
    voided = [died if p is dead else p for p in pairs]
    record = announcing(one_seed, reconstruction=1)
    assert begun(one_seed, record, voided) == [1, 2, 3]
    said = captions(voided)
    assert (dead.scene, 0) not in said
    assert all("of 3 scenes" in each for each in said.values())


def test_the_choice_is_fixed_and_counts_every_seed(three_seeds: ReportInput) -> None:
    record = three_seeds.record
    pairs = read_pairs(three_seeds.trials, record)
    chosen = choose(record, pairs)
    assert chosen == choose(record, pairs)
    shown = [scene for scene, _ in chosen]
    assert len(set(shown)) == len(shown) == 6
    assert ("doorways-017", 0) not in captions(pairs)  # its trial failed with that seed
    assert all("of 239 (80 scenes, 3 seeds)" in said for said in captions(pairs).values())
