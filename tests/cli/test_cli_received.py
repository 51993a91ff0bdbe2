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
    for name in (f"{evil}:create", "evil:create", "run/evil.py:create"):
        edit(run / "record.json", lambda content, n=name: content["question"].update(system=n))
        sign(run)
        ended = faultpath("report", run)
        assert (ended.status, ended.err) == (0, "")
        assert not harm.exists()
        assert not [name for name in sys.modules if "evil" in name]


def table(change: Callable[[pa.Table], pa.Table], name: str = "outcomes.parquet") -> Change:
    """Return what changes a table of a run."""
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
    """Leave a file's digest out."""
    edit(path.parent / "provenance.json", lambda content: content["files"].pop(path.name))


def pipe(path: Path) -> None:
    path.unlink()
    os.mkfifo(path)


SPOILT = {
    **{f"no digest of {name}": (unnamed, name, "") for name in FILES},
    **{f"no {name}": (Path.unlink, name, "") for name in FILES},
    **{f"pipe {name}": (pipe, name, "it is a pipe") for name in (*FILES, "provenance.json")},
}


@pytest.mark.parametrize(("spoil", "name", "says"), SPOILT.values(), ids=SPOILT)
def test_what_is_no_file_or_has_no_digest_is_not_read(
    spoil: Callable[[Path], object], name: str, says: str, run: Path
) -> None:
    spoil(run / name)
    faultpath("report", run).refused(name, says)


@pytest.mark.parametrize("name", ["../../etc/passwd", "/etc/passwd", "a b", "x\ny.json"])
def test_a_digest_of_a_file_elsewhere_is_refused(name: str, run: Path) -> None:
    edit(run / "provenance.json", lambda content: content["files"].update({name: "0" * 64}))
    faultpath("report", run).refused("provenance.json")


def changed(name: str, change: Callable[[dict], object]) -> Change:
    return lambda run: edit(run / name, change)


def written(name: str, text: str) -> Change:
    return lambda run: (run / name).write_text(text)


system, record, receipts = (
    partial(changed, name) for name in ("system.json", "record.json", "deliveries.json")
)
PLAN = {"low": [0, 0, 0], "high": [1, 1, 1], "start": [0, 0, 0], "goal": [1, 1, float("nan")]}
PLAN |= {"prisms": [], "pillars": [], "title": "a"}
TAP = {"channel": "x", "consumer": "y.z", "faulted_steps": 1, "altered_steps": 1}
FORGED: dict[str, tuple[str, Change]] = {
    "a step of no time": ("system.json", system(lambda c: c.update(control_dt_s=0))),
    "another format": ("system.json", system(lambda c: c.update(format=2))),
    "a further field": ("system.json", system(lambda c: c.update(code="import os"))),
    "an interface that does not hold": (
        "system.json",
        system(lambda c: c["interface"]["channels"][0].update(sources=["nowhere"])),
    ),
    "a plan that is not finite": ("system.json", system(lambda c: c["plans"].update(x=PLAN))),
    "a binding that is not offered": (
        "system.json",
        system(lambda c: c["variants"][0].update(bindings={"gain": "odometer"})),
    ),
    "a tap that does not exist": (
        "system.json",
        system(lambda c: c["variants"][0].update(consumers=["nobody.reads"])),
    ),
    "other variants": ("variants", system(lambda c: c.update(variants=[]))),
    "deep": ("system.json", written("system.json", "[" * 100_000)),
    "an effect on no path": (
        "conditions",
        record(lambda c: c["effects"][0].update(path="nowhere")),
    ),
    "no effects": ("contradict", record(lambda c: c.update(effects=[]))),
    "a change of nothing": (
        "contradict",
        record(lambda c: c["changes"][0].update(isolated="")),
    ),
    "wins without losses": (
        "contradict",
        record(lambda c: c["effects"][0].update(wins=[])),
    ),
    "no cells": ("versions", record(lambda c: c.update(cells=[]))),
    "another count": ("count", record(lambda c: c["cells"][0].update(success=77))),
    "another library": ("libraries", record(lambda c: c["question"].update(library_hash="x"))),
    "a tap that is not there": (
        "injection points",
        record(lambda c: c["paths"][1].update(faulted=[TAP])),
    ),
    "receipts of nothing": ("delivery log leaves out", receipts(lambda c: c.update(rows=[]))),
    "receipts of other taps": (
        "delivery log and result differ",
        receipts(lambda c: [row.update(taps=[]) for row in c["rows"]]),
    ),
    "no receipts": ("deliveries.json", written("deliveries.json", "[]")),
    "a finding that is kept back": (
        "leaves out a finding",
        receipts(lambda c: c.update(findings=["A trial flown again ended otherwise."])),
    ),
    "a status of its own": ("outcomes.parquet", first("status", "<b>")),
    "an odd status": ("won", first("status", "won")),
    "a gap": ("outcomes.parquet", first("scene_index", None)),
    "no seed": ("outcomes.parquet", table(lambda table: table.drop_columns(["seed"]))),
    "no distance": ("no such column", table(lambda t: t.drop_columns(["terminal_distance_m"]))),
    "no table": ("outcomes.parquet", written("outcomes.parquet", "PAR1 not")),
    "a time that is no number": ("time_s is nan", first("time_s", float("nan"))),
    "an endless time": ("time_s is inf", first("time_s", float("inf"))),
    "a time below 0": ("time_s is -1.0", first("time_s", -1.0)),
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


@pytest.mark.parametrize("seeds", [[], [0, 0], [-1], [2**63]])
def test_a_replay_of_seeds_that_are_none_is_one_sentence(seeds: list[int], run: Path) -> None:
    edit(run / "record.json", lambda content: content["question"].update(seeds=seeds))
    sign(run)
    faultpath("replay", run, "--trust").refused("seed")


def test_an_older_folder_is_refused_in_one_sentence(run: Path) -> None:
    """What was written before runs kept what a report needs."""
    edit(run / "provenance.json", lambda content: content.pop("files"))
    (run / "system.json").unlink()
    faultpath("report", run).refused("earlier faultpath", "run it again")


def test_pages_are_not_written_through_a_link_out_of_the_folder(run: Path, tmp_path: Path) -> None:
    (mine := tmp_path / "mine").write_text("mine")
    (run / "table.md").unlink()
    (run / "table.md").symlink_to(mine)
    faultpath("report", run).refused("link out of")
    assert mine.read_text() == "mine"


@pytest.mark.parametrize("name", ["outcomes.parquet", "evidence.parquet"])
def test_claims_say_which_file_of_a_reproduction_was_changed(name: str, tmp_path: Path) -> None:
    shipped = ROOT / "paper/src/faultpath_paper/data/run"
    run = Path(shutil.copytree(shipped, tmp_path / "run"))
    data = (run / name).read_bytes()
    digest = hashlib.sha256(data).hexdigest()
    edit(run / "provenance.json", lambda content: content.update(files={name: digest}))
    flip(run / name, len(data) // 2)
    faultpath("reproduce", "--judge", "--out", run).refused(f"{name} changed since the run")
