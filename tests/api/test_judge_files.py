"""Files of results that are odd, damaged or packed to fill the memory: one sentence each."""

import json
import sys
import zipfile
from collections.abc import Callable, Iterable
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
import yaml
from judged_files import HEADER, inspect_log, judged, samples

from faultpath import UserError
from faultpath.core.files.parquet import Unreadable, read_rows, read_table

WON = [n % 3 > 0 for n in range(12)]
LM_EVAL = "samples_gsm8k_2026-01-02T03-04-05.678901.jsonl"


def refused(results: object, tmp_path: Path, **more: Any) -> str:
    with pytest.raises(UserError) as caught:
        judged(results, tmp_path / "run", **more)
    assert "\n" not in str(caught.value)
    assert not (tmp_path / "run").exists()
    return str(caught.value)


def written(path: Path, cell: object) -> Path:
    """Write one trial with `cell` as its success, in the format that the name says."""
    row = {"variant": "old", "scene": "s0", "success": cell}
    match path.name:
        case "a.parquet":
            pq.write_table(pa.Table.from_pylist([row]), path)
        case "a.jsonl":
            path.write_text(json.dumps(row) + "\n")
        case "a.csv":
            path.write_text(f'variant,scene,success\nold,s0,"{str(cell).replace(chr(34), "")}"\n')
        case "eval_info.json":
            episode = {"episode_ix": 0, "seed": None, "success": cell}
            path.write_text(json.dumps({"per_episode": [episode]}))
        case "log.json":
            sample = {**samples(WON)[0], "scores": {"match": {"value": cell}}}
            about = {"eval": {"task": "sums", "model": "old"}}
            path.write_text(json.dumps({**about, "samples": [sample]}))
        case _:
            line = {"doc_id": 0, "doc_hash": "h", "metrics": ["exact_match"], "exact_match": cell}
            path.write_text(json.dumps(line) + "\n")
    return path


FORMATS = ("a.csv", "a.jsonl", "a.parquet", "eval_info.json", "log.json", LM_EVAL)


@pytest.mark.parametrize("cell", [[1], {"value": 1}], ids=repr)
@pytest.mark.parametrize("name", FORMATS)
def test_a_list_or_group_is_no_success(name: str, cell: object, tmp_path: Path) -> None:
    label = "old=" if name in ("eval_info.json", LM_EVAL) else ""
    path = written(tmp_path / name, cell)
    assert "success is" in refused(f"{label}{path}", tmp_path)


MISTAKES = yaml.safe_load(Path(__file__).with_name("mistakes.yaml").read_text("utf-8"))["files"]


@pytest.mark.parametrize(("name", "content", "sentence"), MISTAKES)
def test_a_damaged_file_is_one_sentence(
    name: str, content: object, sentence: str, tmp_path: Path
) -> None:
    text = content if isinstance(content, str) else json.dumps(content)
    (tmp_path / name).write_text(text)
    label = "old=" if name in ("eval_info.json", LM_EVAL) else ""
    assert sentence in refused(f"{label}{tmp_path / name}", tmp_path)


@pytest.mark.parametrize("name", ["eval_info.json", "log.json", LM_EVAL])
def test_a_column_that_a_layout_does_not_take_is_refused(name: str, tmp_path: Path) -> None:
    path = written(tmp_path / name, 1)
    label = "old=" if name in ("eval_info.json", LM_EVAL) else ""
    sentence = refused(f"{label}{path}", tmp_path, columns={"scene": "doc_id"})
    assert "has its own columns; leave out --column scene=" in sentence


def test_scenes_of_two_tasks_that_would_have_one_name_are_refused(tmp_path: Path) -> None:
    rows = "variant,task,scene,success\nold,a/b,c,1\nnew,a,b/c,1\n"
    (tmp_path / "a.csv").write_text(rows)
    assert "would be called 'a/b/c', as scene 'c' of" in refused(tmp_path / "a.csv", tmp_path)


@pytest.mark.parametrize("separator", ["\u2028", "\x85", "\x1e"])
def test_lines_of_json_end_at_line_feeds_alone(separator: str, tmp_path: Path) -> None:
    trials = [(variant, n, won) for variant in ("old", "new") for n, won in enumerate(WON)]
    lines = [
        f'{{"variant": "{variant}", "scene": "s{n}", "success": {int(won)}, '
        f'"note": "a{separator}b"}}'
        for variant, n, won in trials
    ]
    if separator < " ":  # JSON wants these escaped
        lines = [line.replace(separator, f"\\u{ord(separator):04x}") for line in lines]
    (tmp_path / "a.jsonl").write_bytes("\r\n".join(lines).encode())
    assert judged(tmp_path / "a.jsonl", tmp_path / "run").record.scenes == 12


def test_a_label_that_contradicts_the_file_is_refused(tmp_path: Path) -> None:
    for variant, won in (("old", 0), ("new", 1)):
        rows = "".join(f"{variant},s{n},0,nominal,{won},h\n" for n in range(20))
        (tmp_path / f"{variant}.csv").write_text(HEADER + rows)
    old, new = tmp_path / "old.csv", tmp_path / "new.csv"
    sentence = refused([f"new={old}", f"old={new}"], tmp_path)
    assert "line 2: the file says variant 'old' and the command line 'new'" in sentence
    sentence = refused([f"old@shared={old}", f"new@shared={new}"], tmp_path)
    assert "the file says condition 'nominal' and the command line 'shared'" in sentence
    run = judged([f"old={old}", f"new@nominal={new}"], tmp_path / "run")
    assert run.record.effects[0].sign == 1


def test_a_label_names_the_variant_of_a_model_that_is_no_variant(tmp_path: Path) -> None:
    logs = [inspect_log(tmp_path / variant, "gpt", WON) for variant in ("a", "b")]
    labelled = [f"old={logs[0]}", f"new={logs[1]}"]
    assert judged(labelled, tmp_path / "run").record.question.repair == "new"
    logs = [inspect_log(tmp_path / f"{variant}-named", variant, WON) for variant in ("old", "new")]
    sentence = refused([f"new={logs[0]}", f"old={logs[1]}"], tmp_path / "other")
    assert "the file says variant 'old' and the command line 'new'" in sentence


class Sample(SimpleNamespace):
    """A sample as inspect_ai reads it."""

    def model_dump(self, include: set[str]) -> dict[str, Any]:
        return {name: value for name, value in vars(self).items() if name in include}


def packed(path: Path, texts: Iterable[bytes] = ()) -> str:
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for n, text in enumerate(texts):
            archive.writestr(f"samples/{n}.json", text)
    return str(path)


def reading(monkeypatch: pytest.MonkeyPatch, read: Callable[[str], Any]) -> None:
    """Have inspect_ai installed, with this as what reads its logs."""
    monkeypatch.setitem(sys.modules, "inspect_ai", ModuleType("inspect_ai"))
    log = ModuleType("inspect_ai.log")
    vars(log)["read_eval_log"] = read
    monkeypatch.setitem(sys.modules, "inspect_ai.log", log)


def test_packed_logs_are_read_by_their_package(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def read(path: str) -> Any:
        about = SimpleNamespace(model=Path(path).stem, task="sums")
        return SimpleNamespace(eval=about, samples=[Sample(**each) for each in samples(WON)])

    reading(monkeypatch, read)
    logs = [packed(tmp_path / f"{variant}.eval") for variant in ("old", "new")]
    run = judged(logs, tmp_path / "run")
    assert run.record.scenes == len(WON)
    assert run.record.facts.pairing == "hashes"


def test_a_packed_log_needs_its_package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "inspect_ai.log", None)
    message = refused(packed(tmp_path / "old.eval"), tmp_path)
    for part in ("inspect_ai", "pip install '.[inspect]'", "inspect log convert --to json"):
        assert part in message


@pytest.mark.parametrize("error", [ValueError("two\nlines"), RuntimeError()])
def test_a_damaged_log_is_one_sentence(
    error: Exception, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def read(_: str) -> Any:
        raise error

    reading(monkeypatch, read)
    assert "old.eval: is no sound log of Inspect" in refused(
        packed(tmp_path / "old.eval"), tmp_path
    )
    (tmp_path / "cut.eval").write_bytes(b"PK\3\4")
    assert "cut.eval: is no sound log of Inspect" in refused(tmp_path / "cut.eval", tmp_path)


def test_a_small_log_does_not_fill_the_memory(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    reading(monkeypatch, lambda _: pytest.fail("it was read"))
    path = packed(tmp_path / "old.eval", [b"x" * 2**25] * 9)
    assert "unpacks to more than 256 MiB; give it in parts" in refused(path, tmp_path)


@pytest.mark.parametrize(
    ("rows", "letters", "store_schema"),
    [(2**25, 1, True), (2**10, 2**19, True), (2**10, 2**19, False)],
)
def test_a_small_table_does_not_fill_the_memory(
    rows: int, letters: int, store_schema: bool, tmp_path: Path
) -> None:
    which, path = np.zeros(rows, np.int32), tmp_path / "a.parquet"
    column = pa.DictionaryArray.from_arrays(which, pa.array(["x" * letters]))
    pq.write_table(
        pa.table({"variant": column}), path, compression="zstd", store_schema=store_schema
    )
    data = path.read_bytes()
    assert len(data) < 2**20
    with pytest.raises(Unreadable, match="it unpacks to more than 256 MiB"):
        read_table(data)
    with pytest.raises(Unreadable, match="it unpacks to more than 256 MiB"):
        list(read_rows(data))
    sentence = refused(tmp_path / "a.parquet", tmp_path)
    assert "256 MiB" in sentence or "has no success" in sentence or "has no scene" in sentence


def test_names_that_are_no_text_are_a_damaged_table(tmp_path: Path) -> None:
    data = pa.Array.from_buffers(
        pa.string(), 1, [None, pa.py_buffer(b"\0\0\0\0\2\0\0\0"), pa.py_buffer(b"\xff\xfe")]
    )
    pq.write_table(
        pa.table({"variant": data, "scene": ["s"], "success": [1]}), tmp_path / "a.parquet"
    )
    assert "a.parquet: cannot be read" in refused(tmp_path / "a.parquet", tmp_path)


@pytest.mark.parametrize(
    ("results", "folder", "says"),
    [
        (None, "run", "results: None is no path: give files or folders"),
        ({"scene": [1]}, "run", "is no path"),
        (b"all.csv", "run", "is no path"),
        ("all.csv", 3, "folder: is 3, and must be a Path"),
    ],
)
def test_what_is_no_path_is_refused(results: object, folder: Any, says: str) -> None:
    with pytest.raises(UserError, match=says):
        judged(results, folder)
