"""Audits side by side: what is said of them, what is not, and the page."""

import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest
from page_reader import printed, with_record

from faultpath.analyses.effects import Missing
from faultpath.analyses.facts import ComparisonFacts
from faultpath.analyses.model import Condition
from faultpath.report.compared import Compared, differing, titles, together
from faultpath.report.comparison import effects, headline, page, sentences, shown
from faultpath.report.inputs import ReportInput
from faultpath.report.tables import markdown_grid

if TYPE_CHECKING:
    from playwright.sync_api import Browser

NASTY = '<script>alert("x")</script> & 100 % of _it_ \u202e'
Given = tuple[Compared, ...]


def run(source: ReportInput, number: int, folder: str = "", **asked: object) -> Compared:
    record = source.record
    told = {name: asked.pop(name) for name in {*asked} & {*ComparisonFacts.model_fields}}
    question = record.question.model_copy(update=asked)
    facts = record.facts.model_copy(update=told)
    source = with_record(source, question=question, facts=facts)
    return Compared(number, folder or f"runs/{number}", source)


def signed(one: Compared, condition: str, sign: int, **more: object) -> Compared:
    changed = {"sign": sign, **more}
    told = tuple(
        each.model_copy(update=changed) if each.condition == condition else each
        for each in one.record.effects
    )
    return decided(one, effects=told)


def decided(one: Compared, **changed: object) -> Compared:
    """Return the run with another record."""
    return replace(one, source=with_record(one.source, **changed))


def sizes_of(one_seed: ReportInput, last_p: float) -> Given:
    """Return three sizes of a fault, each significant by itself."""
    runs = [run(one_seed, i, fault=f"calibration={s}") for i, s in enumerate((-0.1, 0.1, 0.2), 1)]
    p_values = (1e-5, 1e-5, last_p)
    return together(
        [signed(one, "shared", -1, p_value=p) for one, p in zip(runs, p_values, strict=True)]
    )


def unlike(one_seed: ReportInput) -> Given:
    """Return two runs between which everything differs that may."""
    options = {"predictor": "wm-a", "plant": "mujoco"}
    second = run(one_seed, 2, fault="calibration=-0.1", options=options, seeds=(0, 1))
    origin = second.provenance
    packages = {**origin.machine.packages, "torch": "2.14.0"}
    machine = origin.machine.model_copy(update={"packages": packages, "python": "3.12.1"})
    code = origin.code.model_copy(update={"system_fingerprint": "1" * 64})
    provenance = origin.model_copy(update={"code": code, "machine": machine})
    source = replace(second.source, provenance=provenance)
    return run(one_seed, 1), replace(second, source=source)


def turned(one_seed: ReportInput, sign: int) -> Given:
    """Return a run that is significant for the baseline, and one with this sign."""
    second = run(one_seed, 2, fault="mass=-0.1")
    return run(one_seed, 1), signed(second, "shared", sign, rates=(95.0, 96.0))


CASES = {
    "significant here and not there": lambda source: turned(source, 0),
    "significant in opposite directions": lambda source: turned(source, 1),
    "three sizes": lambda source: sizes_of(source, 1e-5),
    "three sizes, the last only by itself": lambda source: sizes_of(source, 0.04),
    "unlike runs": unlike,
}


@pytest.mark.parametrize("name", CASES)
def test_what_is_said_is_what_was_approved(name: str, one_seed: ReportInput, approved) -> None:
    runs = CASES[name](one_seed)
    facts = [f"{fact}: {' | '.join(values)}" for fact, values in dict(differing(runs)).items()]
    parts = (headline(runs), *sentences(runs), "", *facts, "", markdown_grid(effects(runs)))
    approved(name, "\n".join(parts))


@pytest.mark.parametrize(
    ("update", "said"),
    [
        ({"rates": (96.0, 95.0)}, "gru ahead (ceiling)"),
        ({"missing": Missing(uneven=True)}, "gru ahead (failed trials)"),
        ({"corrected_p": None, "sign": 0}, "fault never acted"),
    ],
)
def test_a_headline_of_sizes_says_what_keeps_an_effect_out_of_headlines(
    one_seed: ReportInput, update: dict[str, Any], said: str
) -> None:
    """An effect at the ceiling stood there as any other, and failed trials as "at the" these."""
    sign = int(update.pop("sign", -1))
    runs = [run(one_seed, i, fault=f"calibration={s}") for i, s in enumerate((0.1, 0.2), 1)]
    runs = [signed(decided(of, changes=()), "shared", sign, p_value=1e-5, **update) for of in runs]
    tested = together(runs)
    assert headline(tested).endswith(f", under the shared fault: {said} at every size")
    apart = run(one_seed, 1), signed(run(one_seed, 2, fault="mass=-0.1"), "shared", 1, **update)
    assert "(at the failed" not in " ".join(sentences(apart))


def test_sizes_without_a_pair_are_not_called_insignificant(
    one_seed: ReportInput, make: Callable[..., ReportInput]
) -> None:
    sources = (make(lost="shared"), one_seed)
    runs = [run(of, i, fault=f"calibration={i}") for i, of in enumerate(sources, 1)]
    runs = [decided(of, changes=()) for of in runs]
    assert "every pair missing at 1; " in headline(runs)


def test_runs_that_are_alike_differ_in_nothing(one_seed: ReportInput) -> None:
    assert dict(differing((run(one_seed, 1), run(one_seed, 2)))) == {}


@pytest.mark.browser
def test_sizes_of_one_fault_are_drawn_over_the_size(
    one_seed: ReportInput, browser: "Browser", tmp_path: Path
) -> None:
    three, mixed = sizes_of(one_seed, 1e-5), sizes_of(one_seed, 0.04)
    assert mixed[2].headline.startswith("By itself, and not over all sizes: ")
    assert mixed[2].headline in page(mixed)
    shared = titles(three)["shared"]
    for runs, spots in ((three, 3), (mixed, 2)):
        panel = next(each for each in page(runs).split("<figure>")[1:] if shared in each)
        assert panel.count('class="dot baseline"') == spots
    other = (*three[:2], run(one_seed, 3, fault="calibration=0.2", seeds=(7,)))
    assert "over all sizes together" not in page(other), "not only the fault differs"
    (tmp_path / "sweep.html").write_text(page(three))
    with browser.new_context(viewport={"width": 390, "height": 800}) as context:
        tab = context.new_page()
        tab.goto((tmp_path / "sweep.html").as_uri())
        assert tab.evaluate("document.documentElement.scrollWidth <= innerWidth")


@pytest.mark.parametrize("width", [80, 120])
def test_long_names_leave_numbers_whole_on_a_terminal(one_seed: ReportInput, width: int) -> None:
    long = "runs/mine.py_create-blind-vs-calibrated-gain_scale=0.6-held-out-100-scenes-4c1f"
    runs = tuple(run(one_seed, number, f"{long}{number}") for number in (1, 2))
    table = printed(shown(runs), width).partition("bold is significant")[2]
    assert "1  mine.py_create-" in table
    for row in effects(runs).lines:
        for entry in row.entries[:2]:
            assert f" {entry.text}" in table


def test_other_conditions_are_blank_and_not_left_out(
    one_seed: ReportInput, make: Callable[..., ReportInput]
) -> None:
    lost = make(lost="predictor")
    first, second = run(lost, 1), run(one_seed, 2)
    record, moved = second.record, {"condition": "planner"}
    planner = Condition(name="planner", title="Planner only", readers=(), baseline_readers=())
    copied = [cell for cell in record.counts if cell.condition == record.effects[1].condition]
    secondary = (*record.secondary, record.secondary[1].model_copy(update=moved))
    update = {
        "secondary": secondary,
        "conditions": (*record.conditions, planner),
        "effects": (*record.effects, record.effects[1].model_copy(update=moved)),
        "counts": (*record.counts, *(cell.model_copy(update=moved) for cell in copied)),
    }
    second = decided(second, **update)
    runs = (first, second)
    assert list(titles(runs)) == ["correct", "predictor", "reconstruction", "planner", "shared"]
    table = effects(runs)
    told = [(line.label, line.entries[-1].text) for line in table.lines if line.entries]
    assert told[2][1] == "every pair missing"
    assert told[6][1] == "not run"
    text = page(runs)
    panels = re.findall(r"<svg.*?</svg>", text, re.DOTALL)
    assert len(panels) == 5
    scales = {tuple(re.findall(r'text-anchor="middle">(−?\d+)</text>', svg)) for svg in panels}
    assert len(scales) == 1, "one scale for all"
    assert all("difference, pp" in svg for svg in panels)


def test_hostile_names_are_text(one_seed: ReportInput) -> None:
    runs = (
        run(one_seed, 1, NASTY, fault=NASTY, baseline=NASTY),
        run(one_seed, 2, repair=NASTY, options={NASTY: NASTY}, system=NASTY),
    )
    counts = [cell.model_copy(update={"variant": NASTY}) for cell in runs[0].record.counts]
    runs = tuple(decided(each, counts=(*each.record.counts, *counts)) for each in runs)
    text = page(runs)
    assert "<script>alert" not in text
    assert "\u202e" not in text
    assert "&lt;script&gt;" in text
