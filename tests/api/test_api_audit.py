"""The front door: an audit from Python, by name, by file and by object; and a check."""

import io
import subprocess
import sys
from importlib import import_module
from pathlib import Path

import pyarrow as pa
import pytest
from cli_runs import faultpath as command
from rich.console import Console
from toy_audits import AUDIT, FILE, TOY

import faultpath
from faultpath.api.display import Display
from faultpath.core.files.parquet import read_table
from faultpath.report.audit_tables import markdown_table
from faultpath.report.html import report_page
from faultpath.report.sentences import words
from faultpath.report.sentences.answers import answers
from faultpath.report.terminal import decision
from faultpath.run.store.folder import OUTCOMES
from faultpath.run.store.signals import encode_signals
from faultpath.run.store.tables import encode_outcomes, encode_traces

QUESTION = {**AUDIT, "scenes": 12, "signals": False}
SEQUENTIAL = {**QUESTION, "scenes": 60, "stop_when": "decided"}


pytestmark = pytest.mark.usefixtures("elsewhere", "without_pages")


@pytest.fixture(scope="module")
def toy():
    return type(faultpath.load_system(TOY))()


@pytest.fixture(scope="module")
def run(tmp_path_factory) -> faultpath.Run:
    folder = tmp_path_factory.mktemp("door") / "run"
    return faultpath.audit(TOY, folder=folder, **QUESTION | {"signals": True})


def _outcomes(run: faultpath.Run) -> list[dict]:
    columns = ("variant", "condition", "seed", "scene", "status", "terminal_distance_m")
    return run.table().select([*columns, "faulted_steps"]).to_pylist()


def test_a_run_holds_what_was_decided_and_from_what(run):
    assert "blind" in run.headline
    assert run.record.facts.n_scenes == 12
    assert run.failed == 0
    assert isinstance(run.table(), pa.Table)
    assert run.table().num_rows == 12 * 2 * 4
    assert run.headline in repr(run)
    (called,) = run.provenance.command
    assert called.startswith(f"faultpath.audit(system={TOY!r}, ")
    assert "baseline='calibrated'" in called


def test_the_rule_is_in_the_record_and_no_result_is_decided_anew_by_another(run, tmp_path):
    assert "Tests: E+M test and weighted Holm." in markdown_table(run.record)
    text = io.StringIO()
    Console(file=text, width=200).print(decision(run.record, details=True))
    assert "McNemar" in text.getvalue()
    assert all(effect.mcnemar_p is not None for effect in run.record.effects)


def test_what_is_read_back_is_what_was_held(run):
    again = faultpath.open_run(str(run.folder))
    assert again.record == run.record
    assert again.provenance == run.provenance
    held, read = run.inputs, again.inputs
    assert read.system == held.system
    assert (run.folder / OUTCOMES).read_bytes() == encode_outcomes(held.trials)
    assert encode_outcomes(read.trials) == encode_outcomes(held.trials)
    assert encode_traces(read.trials) == encode_traces(held.trials)
    assert list(read.signals) == list(held.signals) != []
    assert encode_signals(read.signals) == encode_signals(held.signals)
    assert report_page(read) == report_page(held)
    assert again.table() == run.table() == read_table((run.folder / OUTCOMES).read_bytes())


def test_a_folder_that_is_none_is_named_and_a_notebook_shows_a_run(run):
    with pytest.raises(faultpath.UserError, match=r"nowhere holds no provenance\.json"):
        faultpath.open_run("nowhere")
    with pytest.raises(faultpath.UserError, match="3 is no path: give the folder of a finished"):
        faultpath.open_run(3)
    shown = run._repr_markdown_()
    assert run.headline.partition(" ")[0] in shown
    assert "Won:lost" in shown


@pytest.mark.parametrize(
    ("way", "workers", "name"),
    [("path", 0, TOY), ("loaded", 2, TOY), ("object", None, "Toy object")],
)
def test_whatever_names_a_system_runs_the_same(way, workers, name, run, toy):
    ways = {"path": FILE, "loaded": faultpath.load_system(str(FILE)), "object": toy}
    other = faultpath.audit(ways[way], folder="other", **QUESTION | {"workers": workers})
    assert _outcomes(other) == _outcomes(run)
    assert other.record.effects == run.record.effects
    assert other.record.facts.system == name
    assert other.provenance.machine.workers == (workers or 0)


def test_an_object_that_was_changed_is_not_taken_for_what_was_loaded():
    loaded = faultpath.load_system(TOY)
    loaded.block_size = 3
    with pytest.raises(faultpath.UserError, match="an object cannot be sent to worker processes"):
        faultpath.audit(loaded, **QUESTION | {"workers": 2})


def test_trials_of_an_object_are_never_taken_for_those_of_another(toy):
    text = io.StringIO()
    question = QUESTION | {"workers": None}
    first = faultpath.audit(toy, **question | {"progress": Display(Console(file=text))})
    assert "The system is an object, so it runs in this process" in text.getvalue()
    assert "Running: 96 of 96 trials" in text.getvalue()
    second = faultpath.audit(toy, **question)
    assert first.folder != second.folder
    assert second.provenance.blocks_kept == 0
    with pytest.raises(faultpath.UserError, match="nothing shows whether it was of this same"):
        faultpath.audit(toy, folder=first.folder, **question)


@pytest.mark.parametrize(
    ("system", "options", "sentence"),
    [
        (3, {}, "a system is a name, a file or a faultpath.System, not 3"),
        (TOY, {"options": {"wind": "L3"}}, "'wind': it takes none"),
        (TOY, {"baseline": None}, "baseline: is empty, and must be text"),
        (TOY, {"scenes": "12"}, "scenes: is '12', and must be a whole number"),
        (TOY, {"sceens": 3}, "did you mean 'scenes'"),
        (TOY, {"seeds": (0, -1)}, "-1 is not a seed"),
        (TOY, {"workers": -1}, "the number of workers is -1"),
        (TOY, {"folder": ""}, "folder: an empty path names nothing"),
        (TOY, {"folder": "a\0b"}, "folder: a path cannot have a null character"),
        (None, {"options": {"wind": "L3"}}, "options build a system, and this one is built"),
        (TOY, {"margin_pp": 5.0}, "give it with --stop-when"),
        (TOY, SEQUENTIAL | {"margin_pp": 0.0}, "between 0 and 100"),
        (TOY, SEQUENTIAL | {"stop_when": "soon"}, "'decided' or 'all-decided'"),
        (TOY, SEQUENTIAL | {"generalise": "models", "seeds": (0, 1)}, "leave --stop-when or"),
    ],
)
def test_what_cannot_be_asked_is_one_sentence(system, options, sentence, toy, tmp_path):
    with pytest.raises(faultpath.UserError, match=sentence) as refusal:
        faultpath.audit(toy if system is None else system, **(QUESTION | options))
    assert "\n" not in str(refusal.value)
    assert list(tmp_path.iterdir()) == []


NOTEBOOK = f"""
import sys
sys.path.append({str(FILE.parent)!r})
import faultpath, toy

class Mine(toy.Toy):
    pass

question = {QUESTION!r}
question |= {{"progress": True, "scenes": 4}}
named = faultpath.audit({TOY!r}, **question | {{"workers": 2}})
mine = faultpath.audit(Mine(), **question | {{"workers": None}})
print(named.record.effects == mine.record.effects, mine.provenance.code.system_commit)
"""


def test_what_is_typed_in_runs_and_needs_no_guard(tmp_path):
    """As in a notebook: the class is in no file, and `__main__` has no `if __name__` guard."""
    done = subprocess.run(
        [sys.executable, "-"], input=NOTEBOOK, capture_output=True, text=True, timeout=120
    )
    assert done.stdout == "True None\n", done.stderr
    assert "Running: 32 of 32 trials" in done.stderr


def test_the_command_line_leaves_the_same_record(run):
    options = ["--no-signals", "--fault", "gain:scale=0.6", "--library", "carts", "--scenes", 12]
    variants = ["--baseline", "calibrated", "--repair", "blind", "--workers", 0]
    assert command("audit", TOY, *variants, *options, "--out", "cli").status == 0
    record = Path("cli/record.json").read_text()
    assert record == (run.folder / "record.json").read_text()


@pytest.fixture(scope="module")
def early(tmp_path_factory) -> faultpath.Run:
    place = tmp_path_factory.mktemp("early") / "run"
    return faultpath.audit(TOY, folder=place, **SEQUENTIAL)


def test_a_sequential_audit_stops_and_says_so(early):
    record = early.record
    assert record.stopped is not None
    assert record.stopped.reached
    assert record.stopped.scenes < 60
    assert record.stopped.scenes % record.facts.order.per_analysis == 0
    assert early.table().num_rows == record.stopped.scenes * 2 * 4
    scenes = set(early.table()["scene"].to_pylist())
    assert scenes == set(record.facts.order.scenes[: record.stopped.scenes])
    assert record.effects[-1].sign == -1  # under the shared fault, for the baseline
    assert "ahead" in words(record).headline
    assert f"{record.stopped.scenes} scenes of at most 60" in " ".join(words(record).sentences)


def test_a_sequential_audit_resumes_to_the_same_record(early, tmp_path):
    again = faultpath.audit(TOY, folder=early.folder, **SEQUENTIAL)
    assert again.record == early.record
    assert again.provenance.blocks_computed == 0
    other = faultpath.audit(TOY, folder=tmp_path / "two", **SEQUENTIAL | {"workers": 2})
    assert other.record == early.record
    assert faultpath.open_run(early.folder).record == early.record


def test_a_sequential_audit_without_an_end_takes_all(tmp_path):
    question = {**SEQUENTIAL, "scenes": 6, "stop_when": "all-decided", "margin_pp": 15}
    record = faultpath.audit(TOY, folder=tmp_path / "run", **question).record
    assert (record.stopped.scenes, record.stopped.reached) == (6, False)
    assert words(record).headline.startswith("Too few scenes")


FIVE_PERCENT = "at most 5 % of audits would report any difference"


def extended(**options) -> faultpath.Run:
    """Run an audit in the folder in which the test ran others before."""
    return faultpath.audit(TOY, **(QUESTION | {"folder": "run"} | options))


def earlier(run: faultpath.Run) -> list[tuple]:
    """Return what was concluded in the folder before."""
    return [(analysis.scenes, analysis.primary) for analysis in run.record.earlier]


def test_more_scenes_in_the_same_folder_leave_a_trace_that_stays(monkeypatch):
    def text(run: faultpath.Run) -> str:
        return " ".join((*run.words.findings, *answers(run.record).values()))

    first = extended(scenes=12)
    assert extended(scenes=12).record == first.record
    assert FIVE_PERCENT in text(first)
    assert not first.record.earlier
    more = extended(scenes=20, signals=True)
    assert earlier(more) == [(12, "shared")]
    assert "concluded before with 12 scenes" in text(more)
    assert FIVE_PERCENT not in text(more)
    with monkeypatch.context() as killed:
        killed.setattr(import_module("faultpath.api.audit"), "seal", lambda *_: 1 / 0)
        with pytest.raises(ZeroDivisionError):
            extended(scenes=20, signals=True)
    assert extended(scenes=20).record == more.record
    assert earlier(extended(scenes=12)) == [(20, "shared")]


@pytest.mark.parametrize(
    ("before", "after", "conclusions"),
    [
        ({"scenes": 12}, {"scenes": 12, "primary": "correct"}, [(12, "shared")]),
        ({"scenes": 3}, {"scenes": 12}, []),
    ],
    ids=["another primary effect", "what could not have been significant"],
)
def test_what_was_concluded_before_counts_if_it_could_be_significant(before, after, conclusions):
    extended(**before)
    assert earlier(extended(**after)) == conclusions


def test_sequential_audits_may_be_extended_as_long_as_they_decide_one_effect():
    extended(scenes=15, stop_when="decided")
    assert not earlier(extended(scenes=20, stop_when="all-decided"))
    other = extended(scenes=20, stop_when="all-decided", primary="correct")
    assert earlier(other) == [(None, "shared")]


def test_a_check_of_an_object_is_that_of_its_name(toy):
    options = {"library": "carts", "scenes": 2, "workers": 0, "progress": False}
    report = faultpath.check(FILE, variants=["blind"], **options)
    assert report.failures == ()
    assert report.variants == ("blind",)
    own = faultpath.check(toy, variants=["blind"], **options)
    assert [check.status for check in own.checks] == [check.status for check in report.checks]
    with pytest.raises(faultpath.UserError, match="an object cannot be sent to worker processes"):
        faultpath.check(toy, workers=2)
