"""Mistakes in the code of a user's system: one sentence with its file and line, status 2.
An error of faultpath's own code keeps its traceback."""

import re
import subprocess
from pathlib import Path
from textwrap import dedent

import pytest
from cli_runs import COMMAND, audit, faultpath
from written import HEAD

BROKEN = {
    "syntax": ("def create(:", "SyntaxError"),
    "while loading": ("1 / 0  # here", "ZeroDivisionError: division by zero"),
    "ends the program when built": (
        "def create() -> System:\n    sys.exit(0)  # here",
        "SystemExit",
    ),
    "missing methods": (
        "class Mine(System):\n    name = 'mine'\n"
        "def create() -> System:\n    return Mine()  # here",
        "abstract method",
    ),
    "variant of text": ("Variant('a', 'words', 'abc')  # here", "'abc'"),
    "name with control characters": ("SceneRef('a\\x1b[31m', 0)  # here", "control characters"),
    "index above 2^63": ("SceneRef('a', 2 ** 63)  # here", "2^63 - 1"),
    "scene twice": ("Library('l', (SceneRef('a', 0), SceneRef('a', 1)), 'h')  # here", "'a' twice"),
    "no hash": ("Library('l', (), '')  # here", "content hash"),
    "no scene": ("Library('l', (), 'h')  # here", "library 'l' holds no scene"),
}

DECLARED = {
    "no step": ("control_dt_s = 0.0", "`control_dt_s` is 0.0"),
    "variant under another name": ("variants = {'b': Toy().variants['blind']}", "the name of each"),
    "unknown reader": (
        "variants = {'v': Variant('v', '', frozenset({'nobody.there'}))}",
        "unknown reader 'nobody.there'",
    ),
    "no plant": ("def plant(self):\n        pass", "`plant` returned None: return a Plant"),
    "no modules": (
        "def modules(self, variant, seed):\n        pass",
        "variant 'calibrated' is None: give a list of modules",
    ),
    "fingerprint that fails": ("def fingerprint(self):\n        return 1 / 0  # here", "Zero"),
}

RUN = {
    "list": ("observer.deliver('velocity', 'difference', [0.0], 0)  # here", "Reading"),
    "unknown module": ("taps.for_module('obsever')  # here", "did you mean 'observer'"),
    "no outcomes": ("return []", "one for each"),
}


def _system(tmp_path: Path, code: str) -> tuple[str, str]:
    """Write a system and return its name, and the place that is marked `here`."""
    path = tmp_path / "mine.py"
    path.write_text(f"{HEAD}from toy import Toy\n{code}\n")
    lines = path.read_text().splitlines()
    here = next((n for n, line in enumerate(lines, 1) if line.endswith("# here")), 0)
    return f"{path}:create", f"mine.py, line {here}:" if here else ""


@pytest.mark.parametrize(("code", "words"), BROKEN.values(), ids=BROKEN)
def test_a_system_that_does_not_load(code, words, tmp_path):
    system, place = _system(tmp_path, code)
    sentence = audit(system=system, out="run").refused(place or "mine.py, line", words)
    assert sentence.count("mine.py, line") == 1
    assert not (tmp_path / "run").exists()


def test_a_place_is_named_where_the_working_directory_was_removed(tmp_path, monkeypatch):
    system, place = _system(tmp_path, "1 / 0  # here")
    (gone := tmp_path / "gone").mkdir()
    monkeypatch.chdir(gone)
    gone.rmdir()
    faultpath("trace", system).refused(f"{tmp_path}/{place}", "ZeroDivisionError")


@pytest.mark.parametrize("source", [b"x = 1\0", b"(" * 5000], ids=["NUL", "deep"])
def test_a_file_that_is_no_python(source, tmp_path):
    (tmp_path / "mine.py").write_bytes(source)
    audit(system="mine.py:create").refused("mine.py")


@pytest.mark.parametrize(("code", "words"), DECLARED.values(), ids=DECLARED)
def test_a_system_that_declares_nonsense(code, words, tmp_path):
    code = f"class Mine(Toy):\n    {code}\ndef create() -> System:\n    return Mine()"
    system, place = _system(tmp_path, code)
    audit(system=system, out="run").refused(place, words)
    assert not (tmp_path / "run" / "record.json").exists()


@pytest.mark.parametrize(("what", "workers"), [*((what, 0) for what in RUN), ("list", 1)])
def test_a_system_that_runs_wrongly(what, workers, tmp_path):
    code, words = RUN[what]
    run = f"""
        class Mine(Toy):
            def run(self, variant, scenes, taps, seed):
                observer = taps.for_module("observer")
                {code}
        def create() -> System:
            return Mine()
        """
    system, place = _system(tmp_path, dedent(run))
    sentence = audit(system=system, out="run", workers=workers).refused(place, words)
    assert sentence.count("mine.py, line") <= 1
    traced = audit("--traceback", system=system, out="run", workers=workers)
    assert traced.status == 2
    assert "Traceback (most recent call last)" in traced.err
    assert "faultpath: " in traced.err.splitlines()[-1]


def test_an_error_of_ours_below_a_system_keeps_its_traceback_too(tmp_path):
    """The user's code called, but no argument of his can be the cause."""
    code = """
        import faultpath.core.streams
        def create() -> System:
            return faultpath.core.streams.generator("p", Failing(), 0)
        class Failing:
            pass
        def lost(*_):
            raise RuntimeError("a bug of faultpath")
        lost.__code__ = lost.__code__.replace(co_filename=faultpath.core.streams.__file__)
        faultpath.core.streams.key = lost
        """
    system, _ = _system(tmp_path, dedent(code))
    done = subprocess.run([*COMMAND, "trace", system], capture_output=True, text=True, timeout=60)
    assert done.returncode == 1
    assert "Traceback" in done.stderr
    assert "RuntimeError: a bug of faultpath" in done.stderr


def test_a_wrong_argument_names_the_line_and_leaves_open_whose_fault_it_is(tmp_path):
    code = "from faultpath.interface import read_interface\nread_interface(7)  # here"
    system, place = _system(tmp_path, code)
    faultpath("trace", system).refused(place, "whether the fault is faultpath's")


@pytest.mark.parametrize("before", [True, False])
def test_traceback_goes_before_and_after_the_verb(before):
    line = ["trace", "quadcopter"]
    ended = faultpath("--traceback", *line) if before else faultpath(*line, "--traceback")
    assert ended.status == 2
    assert re.search(r"^Traceback.*\nfaultpath: there is no system", ended.err, re.DOTALL)
    assert "--traceback" in faultpath("--help").out
