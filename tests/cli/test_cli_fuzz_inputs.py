"""Odd files, folders and numbers in great numbers: a sentence each, and no file lost.

`make test` tries a few of the same each time; `make fuzz` tries all, with a seed of its own, which
a failure names with the number of the case.
"""

import hashlib
import re
import shutil
import signal
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from random import Random
from traceback import format_exception

import pytest
from cli_runs import Ended, faultpath
from odd_commands import CASES, bases
from test_cli_fuzz import exit_problem

pytestmark = pytest.mark.fuzz

LIMIT_S = 60
FEW, MANY = 3, 66
"""Cases of each kind in the quick part, and in all."""
INNER = re.compile(r"\b[A-Z][A-Za-z]+(Error|(?<!TProtocol)Exception)\b|correct the system|\(None\)")
"""Words that no sentence about data holds."""
PAGES = (".html", ".md", ".svg", ".csv")
"""Files of a run's folder that `report` and `replay --signals` write again."""


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    if "name" in metafunc.fixturenames:
        metafunc.parametrize("name", list(CASES))


@pytest.fixture(scope="module")
def base(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("bases")
    bases(folder, ("audit", "judge"))
    return folder


@contextmanager
def limited(seconds: float) -> Iterator[None]:
    def end(*_: object) -> None:
        raise TimeoutError(f"it took more than {seconds:g} s")

    before = signal.signal(signal.SIGALRM, end)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)


def digests(folder: Path) -> dict[str, str]:
    """Return the digest of each file that holds anything: a command may fill an empty one."""
    return {
        str(path.relative_to(folder)): hashlib.sha256(path.read_bytes()).hexdigest()
        for path in sorted(folder.rglob("*"))
        if path.is_file() and path.name != ".lock" and path.stat().st_size
    }


def wrong(line: list[str], ended: Ended, before: dict[str, str], here: Path) -> str:
    """Return what is wrong with how a command ended and with what it left, if anything is."""
    if fault := exit_problem(line, ended):
        return fault
    last = ended.err.splitlines()[-1:] or [""]
    if ended.status == 2 and (len(last[0]) < 30 or INNER.search(last[0])):
        return f"nothing is said: {last}"
    after, verb = digests(here), line[0]
    lost = [name for name, digest in before.items() if after.get(name) != digest]
    if verb in ("report", "replay"):  # it writes the pages of its own run, and what it recorded
        own = (*PAGES, *(("signals.parquet", "provenance.json") if verb == "replay" else ()))
        lost = [name for name in lost if not (name.startswith("run/") and name.endswith(own))]
    return f"lost: {lost}" if lost else ""


def test_odd_inputs_end_in_a_sentence(
    name: str,
    base: Path,
    tmp_path: Path,
    fuzz_seed: int,
    monkeypatch: pytest.MonkeyPatch,
    request: pytest.FixtureRequest,
) -> None:
    case, faults = CASES[name], list[str]()
    for number in range(MANY if request.config.getoption("--fuzz-whole") else FEW):
        rng, here = Random(f"{fuzz_seed} {name} {number}"), tmp_path / str(number)
        here.mkdir()
        monkeypatch.chdir(here)
        line = [str(part).encode("utf-8", "replace").decode() for part in case(base, here, rng)]
        before = digests(here)
        try:
            with limited(LIMIT_S):
                fault = wrong(line, faultpath(*line), before, here)
        except Exception as error:  # what the command would end in, with its traceback
            fault = "".join(format_exception(error))[-1500:]
        if fault:
            faults.append(f"seed {fuzz_seed}, {name} {number}: {line}\n{fault}")
        shutil.rmtree(here)
    assert not faults, f"{len(faults)} of them\n" + "\n".join(faults)
