"""`faultpath report` on a folder that somebody else made: data to check, never code to run."""

import hashlib
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
from cli_runs import ROOT, edit, faultpath
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


def unnamed(path: Path) -> None:
    edit(path.parent / "provenance.json", lambda content: content["files"].pop(path.name))


def pipe(path: Path) -> None:
    path.unlink()
    os.mkfifo(path)


SPOILT = {
    "no digest": (unnamed, "deliveries.json", ""),
    "no file": (Path.unlink, "outcomes.parquet", ""),
    "pipe": (pipe, "system.json", "it is a pipe"),
    "pipe for the digests": (pipe, "provenance.json", "it is a pipe"),
}


@pytest.mark.parametrize(("spoil", "name", "says"), SPOILT.values(), ids=SPOILT)
def test_what_is_no_file_or_has_no_digest_is_not_read(
    spoil: Callable[[Path], object], name: str, says: str, run: Path
) -> None:
    spoil(run / name)
    faultpath("report", run).refused(name, says)


@pytest.mark.parametrize("name", ["../../etc/passwd", "x\ny.json"])
def test_a_digest_of_a_file_elsewhere_is_refused(name: str, run: Path) -> None:
    edit(run / "provenance.json", lambda content: content["files"].update({name: "0" * 64}))
    faultpath("report", run).refused("provenance.json")


def changed(name: str, change: Callable[[dict], object]) -> Change:
    return lambda run: edit(run / name, change)


system, record, receipts = (
    partial(changed, name) for name in ("system.json", "record.json", "deliveries.json")
)
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
    "no secondary outcomes": ("contradict", record(lambda c: c.update(secondary=[]))),
    "no cells": ("versions", record(lambda c: c.update(cells=[]))),
    "another count": ("count", record(lambda c: c["cells"][0].update(success=77))),
    "another library": ("libraries", record(lambda c: c["facts"].update(library_hash="x"))),
    "a question that is none": ("question", record(lambda c: c.update(question=5))),
    "another metric": ("'speed'", record(lambda c: c["question"].update(metric="speed"))),
    "a tap that is not there": (
        "injection points",
        record(lambda c: c["conditions"][1].update(faulted=[TAP])),
    ),
    "receipts of nothing": ("delivery log leaves out", receipts(lambda c: c.update(rows=[]))),
    "receipts of other taps": (
        "delivery log and result differ",
        receipts(lambda c: [row.update(taps=[]) for row in c["rows"]]),
    ),
    "a finding that is kept back": (
        "leaves out a finding",
        receipts(lambda c: c.update(findings=["A trial flown again ended otherwise."])),
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


@pytest.mark.parametrize(("says", "forge"), FORGED.values(), ids=FORGED)
def test_a_forged_folder_with_right_digests_ends_in_one_sentence(
    says: str, forge: Change, run: Path
) -> None:
    forge(run)
    sign(run)
    faultpath("report", run).refused(says)


def test_a_replay_of_seeds_that_are_none_is_one_sentence(run: Path) -> None:
    edit(run / "record.json", lambda content: content["question"].update(seeds=[-1]))
    sign(run)
    faultpath("replay", run, "--trust").refused("seed")


def test_an_older_folder_is_refused_in_one_sentence(run: Path) -> None:
    edit(run / "provenance.json", lambda content: content.pop("files"))
    (run / "system.json").unlink()
    faultpath("report", run).refused("earlier faultpath", "run it again")


@pytest.mark.parametrize("name", ["outcomes.parquet", "evidence.parquet"])
def test_claims_say_which_file_of_a_reproduction_was_changed(name: str, tmp_path: Path) -> None:
    shipped = ROOT / "paper/src/faultpath_paper/data/run"
    run = Path(shutil.copytree(shipped, tmp_path / "run"))
    data = (run / name).read_bytes()
    digest = hashlib.sha256(data).hexdigest()
    edit(run / "provenance.json", lambda content: content.update(files={name: digest}))
    flip(run / name, len(data) // 2)
    faultpath("reproduce", "--judge", "--out", run).refused(f"{name} changed since the run")
