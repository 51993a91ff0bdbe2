"""Stored runs are flown again: which of them, in which order, and in which environment."""

import sys
from dataclasses import replace
from pathlib import Path

import pytest
import references
from blocks import Repeats


def test_an_example_of_another_package_runs_where_that_is_installed() -> None:
    runs = references.by_time()
    here = references.environment(runs["toy"])
    assert here.startswith(".venv")
    assert sys.version_info[:2] != (3, 11) or references.environment(runs["motulator"]) != here


def test_a_run_of_another_kind_of_processor_says_that_trials_may_end_differently() -> None:
    toy = references.load("toy")

    def words(processor: str) -> str:
        machine = toy.provenance.machine.model_copy(update={"processor": processor})
        provenance = toy.provenance.model_copy(update={"machine": machine})
        return references.elsewhere(replace(toy, provenance=provenance))

    assert words(references.processor()) == ""
    assert "flown on Abacus" in words("Abacus")


@pytest.fixture
def run_again(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> list[str]:
    """Two runs, of which the code repeats one; the names of those that are run again."""
    toy, names = references.load("toy"), list[str]()
    whole = Repeats(trials=800, sampled=2, repeated=2, near=2)
    lost = whole.model_copy(update={"repeated": 1, "near": 1, "first": "a, b: other status"})
    results = {"same": whole, "other": lost}
    runs = {name: replace(toy, name=name) for name in results}
    monkeypatch.setattr(references, "by_time", lambda: runs)
    monkeypatch.setattr(references, "state", lambda run: "")
    monkeypatch.setattr(references, "KEPT", tmp_path)
    monkeypatch.setattr(references.repeats, "write", lambda run: results[run.name])
    monkeypatch.setattr(references, "checkout", lambda: "0" * 40)
    monkeypatch.setattr(references, "fly", lambda run, _: names.append(run.name))
    monkeypatch.setattr(references.documents, "main", lambda _: 0)
    return names


def test_the_list_says_which_runs_repeat_and_runs_nothing(run_again, monkeypatch, capsys) -> None:
    monkeypatch.setattr(sys, "argv", ["references.py", "--list"])
    references.main()
    same, other = capsys.readouterr().out.splitlines()
    assert same.endswith("all 2 sampled of its 800 trials repeated to the bit by this version")
    assert other.endswith("in 1 of 2 sampled of its 800 trials (a, b: other status)")
    assert run_again == []


def test_only_a_run_that_does_not_repeat_is_run_again(run_again, monkeypatch) -> None:
    monkeypatch.setattr(sys, "argv", ["references.py"])
    with pytest.raises(SystemExit):
        references.main()
    assert run_again == ["other"]


def test_a_sample_is_repeated_once_by_the_same_code(run_again, monkeypatch) -> None:
    repeated: list[str] = []
    toy = references.load("toy")

    def write(run: references.Run) -> Repeats | None:
        repeated.append(run.name)
        return toy.repeats

    monkeypatch.setattr(references.repeats, "write", write)
    for state in ("", "one", "one", "two", ""):
        monkeypatch.setattr(references, "state", lambda run, state=state: state)
        assert references.show([toy]) == {"toy": toy.repeats}
        repeated.append(state)
    assert repeated == ["toy", "", "toy", "one", "one", "toy", "two", "toy", ""]
