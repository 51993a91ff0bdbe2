"""`faultpath report` on a folder that somebody else made: data to check, never code to run."""

import os
import shutil
import sys
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from cli_runs import edit, faultpath
from odd_inputs import sign

FILES = ("record.json", "system.json", "outcomes.parquet", "traces.parquet", "deliveries.json")
Change = Callable[[Path], object]


@pytest.fixture
def run(finished: Path, tmp_path: Path) -> Path:
    return Path(shutil.copytree(finished, tmp_path / "run"))


def test_the_system_that_a_record_names_is_not_imported(run: Path, tmp_path: Path) -> None:
    harm, evil = tmp_path / "harm", tmp_path / "evil.py"
    evil.write_text(f"open({str(harm)!r}, 'w')\n")
    shutil.copy(evil, run / "evil.py")
    for name in ("evil:create", "run/evil.py:create"):
        edit(run / "record.json", lambda content, n=name: content["facts"].update(system=n))
        sign(run)
        ended = faultpath("report", run)
        assert (ended.status, ended.err) == (0, "")
        assert not harm.exists()
        assert not [name for name in sys.modules if "evil" in name]


def table(change: Callable[[pa.Table], pa.Table], name: str = "outcomes.parquet") -> Change:
    return lambda run: pq.write_table(change(pq.read_table(run / name)), run / name)


def first(column: str, value: Any, name: str = "outcomes.parquet") -> Change:
    """Return what gives the first row of a table another value, or what becomes of its own."""

    def change(table: pa.Table) -> pa.Table:
        before, *rest = table[column].to_pylist()
        values = [value(before) if callable(value) else value, *rest]
        array = pa.array(values, type=table.schema.field(column).type)
        return table.set_column(table.column_names.index(column), column, array)

    return table(change, name)


def flip(path: Path, at: int = -3) -> None:
    data = bytearray(path.read_bytes())
    data[at] ^= 1
    path.write_bytes(data)


def another(status: str) -> str:
    return "crash" if status == "success" else "success"


@pytest.mark.parametrize("name", FILES)
def test_a_changed_file_is_named_and_nothing_is_written(name: str, run: Path) -> None:
    if name == "outcomes.parquet":  # a whole table with another result in it
        first("status", another)(run)
    else:
        flip(run / name)
    before = (run / "report.html").stat().st_mtime_ns
    sentence = faultpath("report", run).refused(f"{name} changed since the run")
    assert all(other not in sentence for other in FILES if other != name)
    assert (run / "report.html").stat().st_mtime_ns == before


def changed(name: str, change: Callable[[dict], object]) -> Change:
    return lambda run: edit(run / name, change)


system, record, deliveries, provenance = (
    partial(changed, f"{name}.json") for name in ("system", "record", "deliveries", "provenance")
)


def without(name: str, make: Callable[[Path], object] = lambda path: None) -> Change:
    """Return what takes a file away, and makes something else in its place."""

    def change(run: Path) -> None:
        (run / name).unlink()
        make(run / name)

    return change


def digests(**names: str) -> Change:
    return provenance(lambda content: content["files"].update(names))


SPOILT: dict[str, tuple[str, Change]] = {
    "no digest": ("deliveries.json", provenance(lambda c: c["files"].pop("deliveries.json"))),
    "a digest of a file elsewhere": ("provenance.json", digests(**{"../../etc/passwd": "0" * 64})),
    "a digest of a name of two lines": ("provenance.json", digests(**{"x\ny.json": "0" * 64})),
    "no digests": ("earlier faultpath", provenance(lambda content: content.pop("files"))),
    "no file": ("outcomes.parquet", without("outcomes.parquet")),
    "a pipe": ("it is a pipe", without("system.json", os.mkfifo)),
    "a pipe for the digests": ("it is a pipe", without("provenance.json", os.mkfifo)),
}
PLAN = {"low": [0, 0, 0], "high": [1, 1, 1], "start": [0, 0, 0], "goal": [1, 1, float("nan")]}
PLAN |= {"prisms": [], "pillars": [], "title": "a"}
TAP = {"channel": "x", "reader": "y.z", "faulted_steps": 1, "altered_steps": 1}
FORGED: dict[str, tuple[str, Change]] = {
    "a step of no time": ("system.json", system(lambda c: c.update(control_dt_s=0))),
    "a further field": ("system.json", system(lambda c: c.update(code="import os"))),
    "a plan that is not finite": ("system.json", system(lambda c: c["plans"].update(x=PLAN))),
    "other variants": ("variants", system(lambda c: c.update(variants=[]))),
    "an effect on no condition": (
        "conditions",
        record(lambda c: c["effects"][0].update(condition="nowhere")),
    ),
    "no effects": ("contradict", record(lambda c: c.update(effects=[]))),
    "an effect without counts": (
        "without its counts",
        record(lambda c: c["effects"][0].update(won=[])),
    ),
    "an effect that is not significant": (
        "calls significant what its p-values do not",
        record(lambda c: c["effects"][0].update(sign=1, corrected_p=0.06)),
    ),
    "no secondary outcomes": ("contradict", record(lambda c: c.update(secondary=[]))),
    "no counts": ("versions", record(lambda c: c.update(counts=[]))),
    "another count": ("count", record(lambda c: c["counts"][0].update(success=77))),
    "another library": ("libraries", record(lambda c: c["facts"].update(library_hash="x"))),
    "a question that is none": ("question", record(lambda c: c.update(question=5))),
    "another metric": ("'speed'", record(lambda c: c["question"].update(metric="speed"))),
    "a tap that is not there": (
        "injection points",
        record(lambda c: c["conditions"][1].update(faulted=[TAP])),
    ),
    "a log of nothing": (
        "delivery log leaves out",
        deliveries(lambda c: c.update(rows=[])),
    ),
    "a log of other taps": (
        "delivery log and result differ",
        deliveries(lambda c: [row.update(taps=[]) for row in c["rows"]]),
    ),
    "a finding that is kept back": (
        "leaves out a finding",
        deliveries(lambda c: c.update(findings=[{"kind": "unrecorded", "error": "no"}])),
    ),
    "an odd status": ("won", first("status", "won")),
    "no seed": ("outcomes.parquet", table(lambda table: table.drop_columns(["seed"]))),
    "no distance": ("no such column", table(lambda t: t.drop_columns(["terminal_distance_m"]))),
    "a time that is no number": ("time_s is nan", first("time_s", float("nan"))),
    "no time": ("no time", first("time_s", None)),
    "no distance in one": ("distance_m is nan", first("terminal_distance_m", float("nan"))),
    "steps below 0": ("steps is below 0", first("faulted_steps", -1)),
    "an empty hash": ("initial_hash is empty", first("initial_hash", "")),
    "an uneven trace": ("traces.parquet", first("x_m", lambda x: x[:2], "traces.parquet")),
}


@pytest.mark.parametrize(
    ("words", "change", "signed"),
    [*((*case, False) for case in SPOILT.values()), *((*case, True) for case in FORGED.values())],
    ids=[*SPOILT, *FORGED],
)
def test_a_spoilt_or_forged_folder_ends_in_one_sentence(
    words: str, change: Change, signed: bool, run: Path
) -> None:
    change(run)
    sign(run) if signed else None
    faultpath("report", run).refused(words)


def test_a_replay_of_seeds_that_are_none_is_one_sentence(run: Path) -> None:
    edit(run / "record.json", lambda content: content["question"].update(seeds=[-1]))
    sign(run)
    faultpath("replay", run, "--trust").refused("seed")
