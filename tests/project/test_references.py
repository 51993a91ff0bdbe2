"""Stored runs are flown again: which of them, in which order, and in which environment."""

import sys
from dataclasses import replace

import flown_code
import pytest
import references


def test_every_stored_audit_and_map_is_flown_again_and_the_quickest_first() -> None:
    runs = references.by_time()
    stored = {path.parent.name for path in references.REFERENCE.glob("*/record.json")}
    assert stored - {*references.APART} <= {*runs}
    times = [run.provenance.wall_s for run in runs.values()]
    assert times == sorted(times)
    for run in runs.values():
        command = run.provenance.command
        assert command[:2] in (("faultpath", "audit"), ("faultpath", "map"))
        assert "--out" in command


def test_an_example_of_another_package_runs_where_that_is_installed() -> None:
    runs = references.by_time()
    here = references.environment(runs["toy"])
    assert here.startswith(".venv")
    assert sys.version_info[:2] != (3, 11) or references.environment(runs["motulator"]) != here


def test_a_run_of_another_kind_of_processor_says_that_trials_may_end_differently() -> None:
    toy = references.load("toy")
    here = toy.provenance.model_copy(update={"processor": references.processor()})
    assert references.elsewhere(replace(toy, provenance=here)) == ""
    there = toy.provenance.model_copy(update={"processor": "Abacus"})
    assert "flown on Abacus" in references.elsewhere(replace(toy, provenance=there))


def test_only_a_run_of_other_code_is_stale_and_flown_again(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Both sentences about a run end with "changed since": only the digests tell them apart."""
    toy, here = references.load("toy"), flown_code._state("examples/toy.py:create", ())
    ours = toy.provenance.model_copy(update={"sources": here.files, "data": here.data})
    theirs = ours.model_copy(update={"sources": dict.fromkeys(here.files, "0" * 64)})
    runs = {
        name: replace(toy, name=name, provenance=of)
        for name, of in (("same", ours), ("other", theirs))
    }
    flown: list[str] = []
    monkeypatch.setattr(references, "by_time", lambda: runs)
    monkeypatch.setattr(references, "checkout", lambda: "0" * 40)
    monkeypatch.setattr(references, "fly", lambda run, _: flown.append(run.name))
    monkeypatch.setattr(references.documents, "main", lambda _: 0)
    monkeypatch.setattr(sys, "argv", ["references.py", "--list"])
    references.main()
    same, other = capsys.readouterr().out.splitlines()
    assert same.endswith("  as it was flown")
    assert other.endswith("  stale")
    monkeypatch.setattr(sys, "argv", ["references.py"])
    with pytest.raises(SystemExit):
        references.main()
    assert flown == ["other"]
