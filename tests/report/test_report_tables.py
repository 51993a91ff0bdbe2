"""Markdown and terminal tables: escaped, complete, and with the record's numbers."""

from pathlib import Path

import pytest
from page_reader import printed, with_facts, with_record

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
    text = printed(decision(one_seed.record, details=details), 120)
    lines = (line.rstrip() for line in text.splitlines())
    approved(f"terminal{', details' * details}", "\n".join(lines))


def test_times_that_no_trial_has_are_one_sentence_and_no_column(one_seed: ReportInput) -> None:
    counts = [c.model_copy(update={"median_time_s": None}) for c in one_seed.record.counts]
    page = report_page(with_record(one_seed, counts=tuple(counts)))
    assert "No time of a success is known." in page
    assert "edian time of successes" not in page


def test_findings_stand_below_the_headline_doubts_first(one_seed: ReportInput) -> None:
    source = with_record(one_seed, earlier=(EarlierAnalysis(scenes=20, primary="shared"),))
    page = report_page(source)
    for text in (printed(decision(source.record)), page[page.index("<h1") :]):
        marks = ("Do not choose", "Found in the run", "concluded before", "1 trial of", "80.0")
        assert list(map(text.index, marks)) == sorted(map(text.index, marks))


def undetected(source: ReportInput) -> AuditResult:
    """Return the record as if its last effect, whose interval leaves out 0, was not detected."""
    *others, last = source.record.effects
    last = last.model_copy(update={"sign": 0, "corrected_p": 0.25})
    return with_record(source, effects=(*others, last)).record


def test_details_say_everything_once(one_seed: ReportInput) -> None:
    text = printed(decision(undetected(one_seed), details=True), 400)
    said = [line.strip() for line in text.splitlines() if len(line.split()) > 9]
    assert len(said) == len(set(said))
    assert text.count("the interval excludes 0, but") == 1


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
    source = with_facts(one_seed, faults=read)
    assert faults(source.record.facts) == words.removesuffix(" (kg)")
    assert f"<dd>{words}</dd>" in report_page(source)


def test_results_of_other_tools_show_no_seed_that_they_do_not_name(one_seed: ReportInput) -> None:
    for seeds, text in (((0,), ""), ((0, 1), ", seeds 0, 1"), ((3,), ", seed 3")):
        assert seeds_run(with_facts(one_seed, pairing="keys", seeds=seeds).record.facts) == text
    assert seeds_run(one_seed.record.facts) == ", seed 0"


def test_the_terminal_takes_names_literally(one_seed: ReportInput) -> None:
    title = {"title": "[red]Shared[/]"}
    conditions = tuple(c.model_copy(update=title) for c in one_seed.record.conditions)
    assert title["title"] in printed(decision(with_record(one_seed, conditions=conditions).record))


RECORDS = sorted((Path(__file__).parents[2] / "docs" / "reference").glob("*/record.json"))


@pytest.mark.parametrize("path", RECORDS, ids=lambda path: path.parent.name)
def test_a_narrow_terminal_cuts_no_number(path: Path) -> None:
    record = AuditResult.model_validate_json(path.read_bytes())
    text = printed(decision(record), 80)
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
    changed, left_out = undetected(one_seed), "the interval excludes 0"
    assert "0.250" in version_ahead(changed, changed.effects[-1]).aside
    assert left_out in markdown_table(changed)
    assert left_out not in markdown_table(one_seed.record)
