"""A scan: which trials it runs, what it lists, in words and commands, and what it refuses."""

import json
import math
from pathlib import Path
from typing import Any

import pytest
import yaml
from scan_toy import Cost, Planted, names, planned, scanned

from faultpath.analyses.scan.analysis import COSTLY_PP, FIRST_SCENES, HALVINGS, TRIALS
from faultpath.analyses.scan.model import ScanResult
from faultpath.analyses.scan.ranking import PROBED_SCENES
from faultpath.core.errors import UserError
from faultpath.report.scan import tables
from faultpath.report.sentences import words
from faultpath.stats.cancelling import LEVEL, MOST, REGAINED
from faultpath.stats.estimate import ALPHA

ROOT = Path(__file__).resolve().parents[2]


def both(one: str, other: str, size: float = 1.0) -> Cost:
    """Return the cost of two errors of which only the sum is felt."""
    return lambda at: size * abs(at.get(one, 0.0) + at.get(other, 0.0))


def covered(at: Any) -> float:
    """Return the cost of an error at one reader, which the same error at the other one hides."""
    return 0.4 if at.get("one.pair") and not at.get("two.pair") else 0.0


def listed(record: ScanResult, version: int = 0) -> list[tuple[str | None, set[str]]]:
    return [(pair.kind, names(record, pair.errors)) for pair in record.versions[version].listed]


@pytest.mark.parametrize(
    ("cost", "sources", "pairs"),
    [
        (both("one.a", "two.b"), "abc", [{"a-one", "b+two"}, {"a+one", "b-two"}]),
        (lambda at: 0.3 * sum(map(abs, at.values())), "abc", []),
        (lambda at: 0.0, "abc", []),
        (lambda at: 0.9 * bool(at.get("one.a")), "abc", []),
        (lambda at: 0.4 - 0.4 * bool(at.get("one.a")), "abc", []),
    ],
    ids=["cancel", "add up", "nothing", "one at the floor", "one helps"],
)
def test_only_errors_that_cancel_are_listed(cost: Cost, sources: str, pairs: list[set[str]]):
    record, *_ = scanned(Planted(cost, tuple(sources)))
    assert [of for _, of in listed(record)] == pairs
    assert all(kind == "cancel" for kind, _ in listed(record))
    assert len(words(record).commands) == len(pairs)
    assert ("no pair of errors is shown to cancel" in words(record).headline.lower()) == (not pairs)


SAID = {
    "two cancel": (both("one.a", "two.b"), ("a", "b"), {}),
    "one raises success": (lambda at: 0.4 - 0.4 * bool(at.get("one.a")), ("a", "b"), {}),
    "one covers for another": (covered, ("a", "pair"), {}),
    "a repair that gets no error": (both("one.a", "two.b"), ("a", "b"), {"repair": "deaf"}),
    "costly sizes": (
        lambda at: min(1.0, 2.0 * abs(at.get("one.pair", 0.0) - at.get("two.pair", 0.0))),
        ("pair",),
        {},
    ),
}


@pytest.mark.parametrize("name", SAID)
def test_what_is_said_is_what_was_approved(name: str, approved):
    cost, sources, arguments = SAID[name]
    record, *_ = scanned(Planted(cost, sources), **arguments)
    approved(
        name,
        "\n".join(
            (words(record).headline, "", *words(record).sentences, "", *words(record).commands)
        ),
    )


@pytest.mark.parametrize(("scenes", "few"), [(60, True), (400, False)])
def test_that_few_scenes_are_left_for_pairs_is_said(scenes: int, few: bool):
    record, *_ = scanned(Planted(both("one.a", "two.b"), ("a", "b"), scenes))
    said = [text for text in words(record).sentences if "may cancel as well" in text]
    assert [text.partition(" only")[0] for text in said] == ["In 10 scenes"] * few


def test_few_pairs_stand_in_the_terminal_and_words_say_what_is_bold():
    record, *_ = scanned(Planted(both("one.a", "two.b"), ("a", "b")))
    for shown in (tables(record), tables(record, math.inf)):
        (pairs,) = (table for table in shown if table.name == "every-pair")
        asides = [entry.aside for line in pairs.lines for entry in line.entries if entry.detected]
        assert asides == ["listed"] * len(record.versions[0].listed) != []
    alone = tables(record)[0]
    bold = {e.aside for line in alone.lines for e in line.entries if e.detected}
    assert bold == {"costs"}
    (version,) = record.versions
    many = version.model_copy(update={"pairs": version.pairs * 4})
    crowd = record.model_copy(update={"versions": (many,)})
    assert "every-pair" not in [table.name for table in tables(crowd)]
    assert "every-pair" in [table.name for table in tables(crowd, math.inf)]


def test_an_error_that_raises_success_goes_no_further():
    _, scan, _ = scanned(Planted(SAID["one raises success"][0], ("a", "b")))
    assert scan.chosen == ()


def test_an_error_that_hides_another_covers_for_it():
    record, scan, _ = scanned(Planted(covered, ("a", "pair")))
    assert listed(record) == [
        ("covers", {"pair-one", "pair-two"}),
        ("covers", {"pair+one", "pair+two"}),
    ]
    assert names(record, scan.chosen) == {"pair-one", "pair+one"}


def test_each_stage_has_scenes_of_its_own_and_all_conditions_of_it():
    def cost(at: Any) -> float:
        return 0.3 * min(1.0, sum(abs(size) > 0 for size in at.values()))

    system = Planted(cost, ("a", "three"))
    record, scan, plans = scanned(system)
    first, second = set(scan.first), set(scan.second)
    assert len(first) == 50
    assert not first & second
    ran = {row.condition: set(row.scenes) for row in plans[0].rows}
    assert len(ran) == 1 + 2 * 4
    assert set.union(*ran.values()) == first
    later = {row.condition for row in plans[-1].rows if set(row.scenes) == second}
    everywhere = "three:offset=0.4@last & three:offset=0.4@one & three:offset=0.4@two"
    for path in (
        "correct",
        "a:offset=0.4@one",
        "a:offset=-0.4@one & three:offset=0.4@two",
        "three:offset=0.4@one & three:offset=0.4@two",
        everywhere,
    ):
        assert path in later
    assert not [path for path in later if {"three:offset=0.4", "three:offset=-0.4"} <= sizes(path)]
    assert {of.left_out for of in record.versions[0].together} == {"", "one", "two", "last"}
    assert record.trials <= 8000


def sizes(path: str) -> set[str]:
    return {part.partition("@")[0] for part in path.split(" & ")}


def test_the_order_of_the_sources_decides_nothing():
    cost = both("one.a", "two.b", 0.8)
    results: list[Any] = []
    for sources in (("a", "b", "c", "pair"), ("pair", "c", "b", "a")):
        record, *_ = scanned(Planted(cost, sources))
        content = json.loads(record.model_dump_json())
        results.append({**content, "ranking": sorted(map(str, content["ranking"]["sources"]))})
    assert results[0] == results[1]


def test_a_size_stays_where_half_of_it_seems_to_cost_nothing():
    """The errors cost 60 points together or not at all: half of one would hide the pair."""

    def cost(at: Any) -> float:
        apart = abs(at.get("one.a", 0.0) + at.get("two.b", 0.0))
        return 0.6 * (apart > 0.3)

    record, scan, _ = scanned(Planted(cost, ("a", "b")))
    assert {error.halvings for error in scan.tried} == {0, 1}
    assert {error.halvings for error in record.errors} == {0}
    assert [of for _, of in listed(record)] == [{"a-one", "b+two"}, {"a+one", "b-two"}]


def test_a_costly_size_is_halved_at_all_readers_of_its_source():
    record, _, plans = scanned(Planted(SAID["costly sizes"][0], ("pair",)))
    assert [plan.rows[0].condition for plan in plans] == ["correct"] * 3
    sizes = {(error.change, error.halvings) for error in record.errors}
    assert sizes == {((-0.2,), 1), ((0.2,), 1)}
    assert [kind for kind, _ in listed(record)] == ["cancel", "cancel"]


def test_the_trials_announced_count_those_of_halved_sizes():
    cost = SAID["costly sizes"][0]
    record, *_ = scanned(Planted(cost, ("pair",)), scenes=70)
    announced = planned(Planted(cost, ("pair",)), scenes=70)
    assert announced.trials(20) < record.trials <= announced.expected(HALVINGS)
    assert f"at most about {announced.expected(HALVINGS)} trials in all" in announced.notice()


def test_a_repair_is_scanned_with_the_same_errors_and_tested_apart():
    record, *_ = scanned(Planted(both("one.a", "two.b")), repair="deaf")
    assert len(listed(record)) == 2
    assert listed(record, 1) == []
    whole, deaf = record.versions
    assert [pair.errors for pair in whole.pairs] == [pair.errors for pair in deaf.pairs]


def test_seeds_count_as_one_scene_and_failed_trials_are_left_out():
    system = Planted(both("one.a", "two.b"))
    pair = "a:offset=-0.4@one & b:offset=0.4@two"
    system.failing = {(pair, "s0060"), ("correct", "s0001")}
    record, scan, _ = scanned(system, seeds=(0, 1))
    assert len(listed(record)) == 2
    assert [of.scenes for of in record.versions[0].listed] == [
        len(scan.second) - 1,
        len(scan.second),
    ]
    assert record.failed == 4
    assert [text for text in words(record).sentences if text.startswith("4 trials failed")]
    once = words(record.model_copy(update={"failed": 1})).sentences
    assert [text for text in once if text.startswith("1 trial failed, and its scene does not")]
    system.failing = {(pair, f"s{i:04d}") for i in range(400)}
    with pytest.raises(UserError, match="is left, because all failed"):
        scanned(system)
    one, two = "a:offset=-0.4@one", "b:offset=0.4@two"
    system.failing = {((one, two)[i % 2], f"s{i:04d}") for i in range(400)}
    with pytest.raises(
        UserError, match=f"no scene is left in which whole ran with {one} and {two}"
    ):
        scanned(system)


def test_trials_that_are_no_pairs_give_no_result():
    system = Planted(both("one.a", "two.b"))
    system.unlike = {("a:offset=-0.4@one & b:offset=0.4@two", "s0060")}
    record, *_ = scanned(system)
    assert (record.invalid, listed(record), words(record).sentences) == ("unpaired", [], ())
    assert "s0060" in words(record).findings[0]
    assert words(record).commands == ()


def test_at_most_ten_errors_go_on_and_the_worst_first():
    def cost(at: Any) -> float:
        return sum(0.05 * abs(size) * len(reader) for reader, size in at.items())

    record, scan, _ = scanned(Planted(cost, ("a", "b", "c", "pair", "three")))
    assert len(record.errors) == 16
    lost = {place: first.loss for place, first in enumerate(record.versions[0].first)}
    assert len(scan.chosen) == 10
    assert [lost[place] for place in scan.chosen] == sorted(lost.values(), reverse=True)[:10]


MISTAKES = yaml.safe_load(Path(__file__).with_name("mistakes.yaml").read_text("utf-8"))["scan"]


@pytest.mark.parametrize(("arguments", "parts"), MISTAKES)
def test_a_mistake_is_one_sentence(arguments: dict[str, Any], parts: list[str]):
    with pytest.raises(UserError) as refused:
        planned(Planted(lambda at: 0.0), **arguments)
    assert all(part in str(refused.value) for part in parts), str(refused.value)
    assert "\n" not in str(refused.value)


def test_a_system_that_says_no_size_is_asked_for_one():
    with pytest.raises(UserError, match=r"a declares no uncertainty.*--fault a:scale=1\.1"):
        planned(Planted(lambda at: 0.0, std=None))


def test_the_page_has_the_numbers_of_the_code():
    page = " ".join((ROOT / "docs" / "scan.md").read_text().split())
    count = {3: "three", 5: "five", 10: "ten"}
    for phrase in (
        f"**First stage**, {FIRST_SCENES} scenes",
        f"costs more than {COSTLY_PP:g} percentage points is halved",
        f"up to {count[HALVINGS]} times",
        f"(p below {LEVEL:g}) go on, {count[MOST]} at most",
        f"as many scenes as {TRIALS:,} trials allow",
        f"regain at least {'half' if REGAINED == 0.5 else REGAINED} of",
        f"Holm's correction at {100 * ALPHA / 2:g} %",
        f"Tested apart, at {100 * ALPHA:g} %",
        f"in {count[PROBED_SCENES]} scenes",
    ):
        assert phrase in page, phrase


def test_errors_that_cannot_act_together_are_no_scan():
    with pytest.raises(UserError, match="a has one reader, so no two errors can act together"):
        planned(Planted(lambda at: 0.0, ("a",)))
    with pytest.raises(UserError, match="name one behind '@'"):
        planned(Planted(lambda at: 0.0, ("a", "pair")), fault=("pair:offset=0.4@one+two",))
