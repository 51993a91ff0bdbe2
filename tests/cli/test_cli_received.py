"""`faultpath report` on a folder that somebody else made: data to check, never code to run."""

import hashlib
import json
import os
import shutil
import sys
from collections.abc import Callable
from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from cli_runs import audit, faultpath

FILES = ("record.json", "system.json", "outcomes.parquet", "traces.parquet", "deliveries.json")


@pytest.fixture(scope="module")
def original(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("received") / "run"
    assert audit(out=folder, scenes=12).status == 0
    return folder


@pytest.fixture
def run(original: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return Path(shutil.copytree(original, tmp_path / "run"))


def _edit(path: Path, change: Callable[[dict], object]) -> None:
    content = json.loads(path.read_text())
    change(content)
    path.write_text(json.dumps(content))


def _sign(run: Path) -> None:
    """Give `provenance.json` the digests of the files as they are, as a forger would."""
    digests = {name: hashlib.sha256((run / name).read_bytes()).hexdigest() for name in FILES}
    change = {"files": digests, "outcomes_sha256": digests["outcomes.parquet"]}
    _edit(run / "provenance.json", lambda content: content.update(change))


def test_the_system_that_a_record_names_is_not_imported(run: Path, tmp_path: Path) -> None:
    harm = tmp_path / "harm"
    evil = tmp_path / "evil.py"
    evil.write_text(f"open({str(harm)!r}, 'w')\n")
    for name in (f"{evil}:create", "evil:create", "run/evil.py:create"):
        _edit(run / "record.json", lambda content, n=name: content["question"].update(system=n))
        _sign(run)
        shutil.copy(evil, run / "evil.py")
        ended = faultpath("report", run)
        assert (ended.status, ended.err) == (0, "")
        assert not harm.exists()
        assert not [name for name in sys.modules if "evil" in name]


@pytest.mark.parametrize("name", FILES)
def test_a_changed_file_is_named_and_nothing_is_written(name: str, run: Path) -> None:
    path = run / name
    if name == "outcomes.parquet":  # a whole table with another result in it
        table = pq.read_table(path)
        status = table.column_names.index("status")
        flipped = ["success", *table["status"].to_pylist()[1:]]
        flipped[0] = "crash" if table["status"][0].as_py() == "success" else "success"
        pq.write_table(table.set_column(status, "status", pa.array(flipped)), path)
    else:
        data = bytearray(path.read_bytes())
        data[-3] ^= 1
        path.write_bytes(bytes(data))
    before = (run / "report.html").stat().st_mtime_ns
    sentence = faultpath("report", run).refused()
    assert f"{name} changed since the run" in sentence
    assert all(other not in sentence for other in FILES if other != name)
    assert (run / "report.html").stat().st_mtime_ns == before


@pytest.mark.parametrize("name", FILES)
def test_a_file_without_a_digest_is_not_shown(name: str, run: Path) -> None:
    _edit(run / "provenance.json", lambda content: content["files"].pop(name))
    assert name in faultpath("report", run).refused()


@pytest.mark.parametrize("name", FILES)
def test_a_missing_file_is_named(name: str, run: Path) -> None:
    (run / name).unlink()
    assert name in faultpath("report", run).refused()


@pytest.mark.parametrize("name", [*FILES, "provenance.json"])
def test_what_is_no_file_is_not_read(name: str, run: Path) -> None:
    (run / name).unlink()
    os.mkfifo(run / name)
    assert f"{name} cannot be read (it is a pipe" in faultpath("report", run).refused()


def _cell(name: str, value: object) -> Callable[[pa.Table], pa.Table]:
    """Return what puts a value into the first row of a column."""

    def change(table: pa.Table) -> pa.Table:
        column = pa.array([value, *table[name].to_pylist()[1:]], type=table[name].type)
        return table.set_column(table.column_names.index(name), name, column)

    return change


@pytest.mark.parametrize(
    ("change", "says"),
    [
        (_cell("time_s", float("nan")), "time_s is nan"),
        (_cell("time_s", float("inf")), "time_s is inf"),
        (_cell("time_s", -1.0), "time_s is -1.0"),
        (_cell("time_s", None), "trials of an audit have no time"),
        (_cell("terminal_distance_m", float("nan")), "terminal_distance_m is nan"),
        (_cell("faulted_steps", -1), "steps is below 0"),
        (_cell("status", "won"), "won"),
        (_cell("initial_hash", ""), "initial_hash is empty"),
        (lambda table: table.drop_columns(["terminal_distance_m"]), "no such column"),
    ],
)
def test_outcomes_that_no_trial_leaves_are_refused(
    run: Path, change: Callable[[pa.Table], pa.Table], says: str
) -> None:
    path = run / "outcomes.parquet"
    pq.write_table(change(pq.read_table(path)), path)
    _sign(run)
    assert says in faultpath("report", run).refused()


@pytest.mark.parametrize("name", ["../../etc/passwd", "/etc/passwd", "a b", "x\ny.json"])
def test_a_digest_of_a_file_elsewhere_is_refused(name: str, run: Path) -> None:
    _edit(run / "provenance.json", lambda content: content["files"].update({name: "0" * 64}))
    assert "provenance.json" in faultpath("report", run).refused()


NOT_FINITE = float("nan")


def _system(change: Callable[[dict], object]) -> Callable[[Path], None]:
    return lambda run: _edit(run / "system.json", change)


def _record(change: Callable[[dict], object]) -> Callable[[Path], None]:
    return lambda run: _edit(run / "record.json", change)


def _receipts(change: Callable[[dict], object]) -> Callable[[Path], None]:
    return lambda run: _edit(run / "deliveries.json", change)


def _table(name: str, change: Callable[[pa.Table], pa.Table]) -> Callable[[Path], None]:
    return lambda run: pq.write_table(change(pq.read_table(run / name)), run / name)


def _with(column: str, values: Callable[[list], list]) -> Callable[[pa.Table], pa.Table]:
    def change(table: pa.Table) -> pa.Table:
        at = table.column_names.index(column)
        new = pa.array(values(table[column].to_pylist()), type=table.schema.field(column).type)
        return table.set_column(at, column, new)

    return change


PLAN = {"low": [0, 0, 0], "high": [1, 1, 1], "start": [0, 0, 0], "goal": [1, 1, NOT_FINITE]}
PLAN |= {"prisms": [], "pillars": [], "title": "a"}
FORGED = {
    "a step of no time": ("system.json", _system(lambda c: c.update(control_dt_s=0))),
    "another format": ("system.json", _system(lambda c: c.update(format=2))),
    "a further field": ("system.json", _system(lambda c: c.update(code="import os"))),
    "an interface that does not hold": (
        "system.json",
        _system(lambda c: c["interface"]["channels"][0].update(sources=["nowhere"])),
    ),
    "a plan that is not finite": ("system.json", _system(lambda c: c["plans"].update(x=PLAN))),
    "a binding that is not offered": (
        "system.json",
        _system(lambda c: c["variants"][0].update(bindings={"gain": "odometer"})),
    ),
    "a tap that does not exist": (
        "system.json",
        _system(lambda c: c["variants"][0].update(consumers=["nobody.reads"])),
    ),
    "other variants": ("variants", _system(lambda c: c.update(variants=[]))),
    "deep": ("system.json", lambda run: (run / "system.json").write_text("[" * 100_000)),
    "an effect on no path": ("path", _record(lambda c: c["effects"][0].update(path="nowhere"))),
    "no effects": ("fit each other", _record(lambda c: c.update(effects=[]))),
    "a change of nothing": (
        "fit each other",
        _record(lambda c: c["changes"][0].update(isolated="")),
    ),
    "wins without losses": ("fit each other", _record(lambda c: c["effects"][0].update(wins=[]))),
    "no cells": ("arms", _record(lambda c: c.update(cells=[]))),
    "another count": ("count", _record(lambda c: c["cells"][0].update(success=77))),
    "another library": ("libraries", _record(lambda c: c["question"].update(library_hash="x"))),
    "a tap that is not there": (
        "taps",
        _record(
            lambda c: c["paths"][1].update(
                faulted=[
                    {"channel": "x", "consumer": "y.z", "faulted_steps": 1, "altered_steps": 1}
                ]
            )
        ),
    ),
    "receipts of nothing": ("without receipts", _receipts(lambda c: c.update(rows=[]))),
    "receipts of other taps": (
        "receipts and record differ",
        _receipts(lambda c: [row.update(taps=[]) for row in c["rows"]]),
    ),
    "no receipts": ("deliveries.json", lambda run: (run / "deliveries.json").write_text("[]")),
    "a finding that is kept back": (
        "leaves out a finding",
        _receipts(lambda c: c.update(findings=["A trial flown again ended otherwise."])),
    ),
    "a status of its own": (
        "outcomes.parquet",
        _table("outcomes.parquet", _with("status", lambda v: ["<b>", *v[1:]])),
    ),
    "a gap": (
        "outcomes.parquet",
        _table("outcomes.parquet", _with("scene_index", lambda v: [None, *v[1:]])),
    ),
    "a missing column": (
        "outcomes.parquet",
        _table("outcomes.parquet", lambda table: table.drop_columns(["seed"])),
    ),
    "no table": (
        "outcomes.parquet",
        lambda run: (run / "outcomes.parquet").write_bytes(b"PAR1 not"),
    ),
    "an uneven trace": (
        "traces.parquet",
        _table("traces.parquet", _with("x_m", lambda v: [v[0][:2], *v[1:]])),
    ),
}


@pytest.mark.parametrize(("says", "forge"), FORGED.values(), ids=FORGED)
def test_a_forged_folder_with_right_digests_ends_in_one_sentence(
    says: str, forge: Callable[[Path], object], run: Path
) -> None:
    forge(run)
    _sign(run)
    assert says in faultpath("report", run).refused()


@pytest.mark.parametrize("seeds", [[], [0, 0], [-1], [2**63]])
def test_a_replay_of_seeds_that_are_none_is_one_sentence(seeds: list[int], run: Path) -> None:
    _edit(run / "record.json", lambda content: content["question"].update(seeds=seeds))
    _sign(run)
    assert "seed" in faultpath("replay", run, "--trust").refused()


def test_an_older_folder_is_refused_in_one_sentence(run: Path) -> None:
    """What was written before runs kept what a report needs."""
    _edit(run / "provenance.json", lambda content: content.pop("files"))
    (run / "system.json").unlink()
    sentence = faultpath("report", run).refused()
    assert "earlier faultpath" in sentence
    assert "run it again" in sentence


def test_pages_are_not_written_through_a_link_out_of_the_folder(run: Path, tmp_path: Path) -> None:
    mine = tmp_path / "mine"
    mine.write_text("mine")
    (run / "table.md").unlink()
    (run / "table.md").symlink_to(mine)
    assert "link out of" in faultpath("report", run).refused()
    assert mine.read_text() == "mine"


@pytest.mark.parametrize("name", ["outcomes.parquet", "evidence.parquet"])
def test_claims_say_which_file_of_a_reproduction_was_changed(name: str, tmp_path: Path) -> None:
    shipped = Path(__file__).resolve().parents[2] / "paper/src/faultpath_paper/data/run"
    run = Path(shutil.copytree(shipped, tmp_path / "run"))
    digest = hashlib.sha256((run / name).read_bytes()).hexdigest()
    _edit(run / "provenance.json", lambda content: content.update(files={name: digest}))
    data = bytearray((run / name).read_bytes())
    data[len(data) // 2] ^= 1
    (run / name).write_bytes(bytes(data))
    assert (
        f"{name} changed since the run" in faultpath("reproduce", "--judge", "--out", run).refused()
    )
