"""Markdown and terminal tables: escaped, complete, and with the record's numbers."""

import io
from dataclasses import replace
from pathlib import Path

import pytest
from rich.console import Console

from faultpath.analyses.facts import EarlierAnalysis
from faultpath.analyses.model import AuditResult
from faultpath.faults import parse_fault
from faultpath.report.audit_tables import by_condition, markdown_table, version_ahead
from faultpath.report.html import _finding, report_page, write_report
from faultpath.report.inputs import ReportInput
from faultpath.report.sentences.wording import faults, seeds_run
from faultpath.report.terminal import decision


@pytest.mark.parametrize("name", ["one seed", "three seeds"])
def test_markdown_is_what_was_approved(name: str, request, approved) -> None:
    source: ReportInput = request.getfixturevalue(name.replace(" ", "_"))
    approved(f"{name}, markdown", markdown_table(source.record))


@pytest.mark.parametrize("details", [False, True])
def test_the_terminal_shows_what_was_approved(one_seed: ReportInput, details, approved) -> None:
    console = Console(file=io.StringIO(), width=120, force_terminal=False)
    console.print(decision(one_seed.record, details=details))
    lines = (line.rstrip() for line in console.file.getvalue().splitlines())  # type: ignore[attr-defined] - a StringIO
    approved(f"terminal{', details' * details}", "\n".join(lines))


def test_times_that_no_trial_has_are_one_sentence_and_no_column(one_seed: ReportInput) -> None:
    counts = [c.model_copy(update={"median_time_s": None}) for c in one_seed.record.counts]
    record = one_seed.record.model_copy(update={"counts": tuple(counts)})
    page = report_page(replace(one_seed, record=record))
    assert "No time of a success is known." in page
    assert "edian time of successes" not in page


def test_findings_stand_below_the_headline_doubts_first(one_seed: ReportInput) -> None:
    earlier = EarlierAnalysis(scenes=20, primary="shared")
    record = one_seed.record.model_copy(update={"earlier": (earlier,)})
    console = Console(width=160)
    with console.capture() as captured:
        console.print(decision(record))
    page = report_page(replace(one_seed, record=record))
    for text in (captured.get(), page[page.index("<h1") :]):
        marks = ("Do not choose", "Found in the run", "concluded before", "1 trial of", "80.0")
        assert list(map(text.index, marks)) == sorted(map(text.index, marks))


def test_details_say_everything_once(one_seed: ReportInput) -> None:
    undetected = one_seed.record.effects[-1].model_copy(update={"sign": 0, "corrected_p": 0.25})
    effects = (*one_seed.record.effects[:-1], undetected)
    record = one_seed.record.model_copy(update={"effects": effects})
    console = Console(width=400)
    with console.capture() as captured:
        console.print(decision(record, details=True))
    said = [line.strip() for line in captured.get().splitlines() if len(line.split()) > 9]
    assert len(said) == len(set(said))
    assert captured.get().count("the interval excludes 0, but") == 1


@pytest.mark.parametrize(
    ("fault", "words"),
    [
        ("mass:offset=0.02", "mass offset by 0.02 (kg)"),
        ("mass:scale=1.1", "mass scaled by 1.1"),
        ("thrust_scale:offset=0.1", "thrust_scale offset by 0.1"),
    ],
)
def test_what_a_fault_adds_has_the_unit_of_its_channel(one_seed: ReportInput, fault, words) -> None:
    read = parse_fault(fault, one_seed.system.interface, {}, 0.05)
    facts = one_seed.record.facts.model_copy(update={"faults": read})
    assert faults(facts) == words.removesuffix(" (kg)")
    source = replace(one_seed, record=one_seed.record.model_copy(update={"facts": facts}))
    assert f"<dd>{words}</dd>" in report_page(source)


def test_results_of_other_tools_show_no_seed_that_they_do_not_name(one_seed: ReportInput) -> None:
    facts = one_seed.record.facts.model_copy(update={"pairing": "keys"})
    for seeds, text in (((0,), ""), ((0, 1), ", seeds 0, 1"), ((3,), ", seed 3")):
        assert seeds_run(facts.model_copy(update={"seeds": seeds})) == text
    assert seeds_run(one_seed.record.facts) == ", seed 0"


def test_the_terminal_takes_names_literally(one_seed: ReportInput) -> None:
    record = one_seed.record
    conditions = (c.model_copy(update={"title": "[red]Shared[/]"}) for c in record.conditions)
    console = Console(width=160)
    with console.capture() as captured:
        console.print(decision(record.model_copy(update={"conditions": tuple(conditions)})))
    assert "[red]Shared[/]" in captured.get()


RECORDS = sorted((Path(__file__).parents[2] / "docs" / "reference").glob("*/record.json"))


@pytest.mark.parametrize("path", RECORDS, ids=lambda path: path.parent.name)
def test_a_narrow_terminal_cuts_no_number(path: Path) -> None:
    console = Console(width=80)
    record = AuditResult.model_validate_json(path.read_bytes())
    with console.capture() as captured:
        console.print(decision(record))
    text = captured.get()
    for row in by_condition(record, ("break-even", "interval", "won"), "").lines:
        assert all(entry.text in text for entry in row.entries), text


@pytest.mark.parametrize("path", RECORDS, ids=lambda path: path.parent.name)
def test_the_two_numbers_below_the_headline_are_both_decided(path: Path) -> None:
    record = AuditResult.model_validate_json(path.read_bytes())
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
    assert "0.250" in version_ahead(changed, undetected).aside
    assert left_out in markdown_table(changed)
    assert left_out not in markdown_table(record)
