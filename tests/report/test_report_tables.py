"""Markdown and terminal tables: escaped, complete, and with the record's numbers."""

import io
import math
import re
from pathlib import Path

import pytest
from rich.console import Console

from faultpath.analyses.record import DecisionRecord
from faultpath.analyses.sentences import wording
from faultpath.report.html import _finding, write_report
from faultpath.report.inputs import ReportInput
from faultpath.report.tables import by_condition, decided_for, markdown_table
from faultpath.report.terminal import decision


def _expected(record: DecisionRecord) -> dict[str, list[str]]:
    effects = record.effects
    breaks = {b.condition: wording.break_even(b.result) for b in record.break_even}
    return {
        "gru (baseline)": [f"{e.rates[0]:.1f}" for e in effects],
        "gru-dcc (repair)": [f"{e.rates[1]:.1f}" for e in effects],
        "Difference, pp": [f"{e.value:+.1f}" for e in effects],
        "95 % interval": [f"[{e.low:.1f}, {e.high:.1f}]" for e in effects],
        "Won:lost": ["/".join(f"{won}:{lost}" for won, lost in e.won) for e in effects],
        "p, alone": [_p(e.p_value) for e in effects],
        "p, Holm": [_p(e.corrected_p) for e in effects],
        "Ahead": [{1: "gru-dcc", -1: "gru", 0: "not shown"}[e.sign] for e in effects],
        "80 % power, pp": [str(math.ceil(e.least_pp)) for e in effects],
        "Scenes": [str(e.scenes) for e in effects],
        "Void pairs": [str(e.void) for e in effects],
        "Break-even, %": [breaks.get(e.condition, "-") for e in effects],
    }


def _p(value: float | None) -> str:
    assert value is not None
    return "< 0.001" if value < 0.001 else f"{value:.3f}"


def _rows(lines: list[list[str]]) -> dict[str, list[str]]:
    rows: dict[str, list[str]] = {}
    for line in lines:
        rows.setdefault(line[0], line[1:])
    return rows


@pytest.fixture(params=["one_seed", "three_seeds"])
def source(request: pytest.FixtureRequest) -> ReportInput:
    return request.getfixturevalue(request.param)


def test_markdown_has_the_numbers_of_the_record(source: ReportInput) -> None:
    text = markdown_table(source.record)
    for escaped, plain in (
        *(("\\", ""), ("**", ""), ("&lt;", "<"), ("&gt;", ">"), ("−", "-"), ("–", "-")),
    ):
        text = text.replace(escaped, plain)
    table = [line.strip("| ").split(" | ") for line in text.splitlines() if line.startswith("|")]
    rows = _rows(table)
    for label, values in _expected(source.record).items():
        assert rows[label] == values


def test_terminal_shows_the_numbers_and_takes_names_literally(one_seed: ReportInput) -> None:
    record = one_seed.record
    conditions = tuple(
        p.model_copy(update={"title": "[red]Shared[/]"}) if p.name == "shared" else p
        for p in record.conditions
    )
    console = Console(file=io.StringIO(), width=160, force_terminal=False)
    console.print(decision(record.model_copy(update={"conditions": conditions})))
    text = console.file.getvalue().replace("−", "-")  # type: ignore[attr-defined] - a StringIO
    text = re.sub(" +", " ", text)
    assert "[red]Shared[/]" in text
    for effect in record.effects:
        assert f"{effect.value:+.1f} [{effect.low:.1f}" in text
        assert f"{effect.rates[0]:.1f}" in text
        assert f"{effect.rates[1]:.1f}" in text
    assert "What would change this" not in text
    with console.capture() as captured:
        console.print(decision(record, details=True))
    whole = " ".join(captured.get().split())
    assert all(" ".join(said.split()) in whole for said in record.sentences)
    assert "What would change this" in whole


RECORDS = sorted((Path(__file__).parents[2] / "docs" / "reference").glob("*/record.json"))


@pytest.mark.parametrize("path", RECORDS, ids=lambda path: path.parent.name)
def test_a_narrow_terminal_cuts_no_number(path: Path) -> None:
    console = Console(width=80)
    record = DecisionRecord.model_validate_json(path.read_bytes())
    with console.capture() as captured:
        console.print(decision(record))
    text = captured.get()
    for row in by_condition(record, ("break-even", "interval", "won"), "").lines:
        assert all(entry.text in text for entry in row.entries), text


@pytest.mark.parametrize("path", RECORDS, ids=lambda path: path.parent.name)
def test_the_two_numbers_below_the_headline_are_both_decided(path: Path) -> None:
    record = DecisionRecord.model_validate_json(path.read_bytes())
    found = [effect for effect, _ in _finding(record)]
    assert bool(found) == any(change.turn == "reversal" for change in record.changes)
    assert all(effect.significant for effect in found)
    assert not found or found[0].value * found[1].value < 0


def test_report_is_written_whole(one_seed: ReportInput, tmp_path: Path) -> None:
    folder = tmp_path / "deep" / "report"
    page, table = write_report(one_seed, folder)
    assert (page.name, table.name) == ("report.html", "table.md")
    before = page.read_bytes()
    write_report(one_seed, folder)
    assert page.read_bytes() == before
    assert {*folder.iterdir()} == {page, table}


def test_an_interval_that_leaves_out_0_undetected_has_its_p(one_seed: ReportInput) -> None:
    record, left_out = one_seed.record, "the interval excludes 0"
    undetected = record.effects[-1].model_copy(update={"sign": 0, "corrected_p": 0.25})
    changed = record.model_copy(update={"effects": (*record.effects[:-1], undetected)})
    assert "0.250" in decided_for(changed, undetected).aside
    assert left_out in markdown_table(changed)
    assert left_out not in markdown_table(record)
