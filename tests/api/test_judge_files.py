"""Files of results that are odd, damaged or packed to fill the memory: one sentence each."""

import json
import lzma
import resource
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from judged_files import HEADER, inspect_log, lm_eval, samples, zstandard

import faultpath
from faultpath import UserError
from faultpath.core.files.parquet import Unreadable, read_rows, read_table

WON = [n % 3 > 0 for n in range(12)]
LM_EVAL = "samples_gsm8k_2026-01-02T03-04-05.678901.jsonl"


def judged(results: object, tmp_path: Path, **more: Any) -> faultpath.Run:
    asked = {"baseline": "old", "repair": "new", "folder": tmp_path / "run", "progress": False}
    return faultpath.judge(results, **(asked | more))  # pyright: ignore[reportArgumentType]


def refused(results: object, tmp_path: Path, **more: Any) -> str:
    with pytest.raises(UserError) as caught:
        judged(results, tmp_path, **more)
    assert "\n" not in str(caught.value)
    assert not (tmp_path / "run").exists()
    return str(caught.value)


def written(path: Path, cell: object) -> Path:
    """Write one trial with `cell` as its success, in the format that the name says."""
    row = {"arm": "old", "scene": "s0", "success": cell}
    match path.name:
        case "a.parquet":
            pq.write_table(pa.Table.from_pylist([row]), path)
        case "a.jsonl":
            path.write_text(json.dumps(row) + "\n")
        case "a.csv":
            path.write_text(f'arm,scene,success\nold,s0,"{str(cell).replace(chr(34), "")}"\n')
        case "eval_info.json":
            episode = {"episode_ix": 0, "seed": None, "success": cell}
            path.write_text(json.dumps({"per_episode": [episode]}))
        case "log.json" | "log.eval":
            sample = {**samples(WON)[0], "scores": {"match": {"value": cell}}}
            about = {"eval": {"task": "sums", "model": "old"}}
            if path.suffix == ".json":
                path.write_text(json.dumps({**about, "samples": [sample]}))
            else:
                files = {"header.json": about, "samples/0_epoch_1.json": sample}
                path.write_bytes(zstandard({k: json.dumps(v).encode() for k, v in files.items()}))
        case _:
            line = {"doc_id": 0, "doc_hash": "h", "metrics": ["exact_match"], "exact_match": cell}
            path.write_text(json.dumps(line) + "\n")
    return path


FORMATS = ("a.csv", "a.jsonl", "a.parquet", "eval_info.json", "log.json", "log.eval", LM_EVAL)


@pytest.mark.parametrize("cell", [[1], [], {"0": True}, {"value": 1}, [[1, 0]]], ids=repr)
@pytest.mark.parametrize("name", FORMATS)
def test_a_list_or_group_is_no_success(name: str, cell: object, tmp_path: Path) -> None:
    label = "old=" if name in ("eval_info.json", LM_EVAL) else ""
    path = written(tmp_path / name, cell)
    assert "success is" in refused(f"{label}{path}", tmp_path)


@pytest.mark.parametrize("name", ["scene", "arm", "seed", "task", "condition", "initial"])
def test_a_list_is_no_name(name: str, tmp_path: Path) -> None:
    row = {"arm": "old", "scene": "s0", "success": 1, name: ["x"]}
    (tmp_path / "a.jsonl").write_text(json.dumps(row))
    assert f"line 1: the {name} is" in refused(tmp_path / "a.jsonl", tmp_path)


@pytest.mark.parametrize("value", [{"0": True, "1": False}, "0101", 3, None], ids=repr)
def test_successes_are_a_list(value: object, tmp_path: Path) -> None:
    """Keys of a group and letters of a text could be gone through as a list's items are."""
    task = {"task_group": "g", "task_id": 0, "metrics": {"successes": value}}
    (tmp_path / "eval_info.json").write_text(json.dumps({"per_task": [task]}))
    said = refused(f"old={tmp_path / 'eval_info.json'}", tmp_path)
    assert "is not laid out as files of its kind are" in said


@pytest.mark.parametrize("more", [{}, {"metrics": []}, {"metrics": {"a": 1}}, {"metrics": "acc"}])
def test_samples_without_a_metric(more: dict[str, Any], tmp_path: Path) -> None:
    (tmp_path / LM_EVAL).write_text(json.dumps({"doc_id": 0, **more}))
    said = refused(f"old={tmp_path / LM_EVAL}", tmp_path)
    assert "names no metric" in said or "is not laid out" in said


@pytest.mark.parametrize("scores", [[{"value": 1}], ["C"], "C", 3, {"match": 1}, {"match": []}])
def test_scores_are_a_group(scores: object, tmp_path: Path) -> None:
    log = {"eval": {"task": "t", "model": "old"}, "samples": [{"id": 0, "scores": scores}]}
    (tmp_path / "log.json").write_text(json.dumps(log))
    assert "is not laid out as files of its kind are" in refused(tmp_path / "log.json", tmp_path)


def test_a_header_alone_holds_no_trial(tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_text(HEADER)
    assert "a.csv: holds no trial" in refused(tmp_path / "a.csv", tmp_path)


@pytest.mark.parametrize("separator", ["\u2028", "\u2029", "\x85", "\x0b", "\x1e"])
def test_lines_of_json_end_at_line_feeds_alone(separator: str, tmp_path: Path) -> None:
    lines = [
        json.dumps(
            {"arm": arm, "scene": f"s{n}", "success": won, "note": f"a{separator}b"},
            ensure_ascii=False,
        )
        for arm in ("old", "new")
        for n, won in enumerate(WON)
    ]
    if separator < " ":  # JSON wants these escaped
        lines = [line.replace(separator, f"\\u{ord(separator):04x}") for line in lines]
    (tmp_path / "a.jsonl").write_bytes("\r\n".join(lines).encode())
    assert judged(tmp_path / "a.jsonl", tmp_path).record.scenes == 12


def test_a_label_that_contradicts_the_file_is_refused(tmp_path: Path) -> None:
    """It would turn the verdict round."""
    for arm, won in (("old", 0), ("new", 1)):
        rows = "".join(f"{arm},s{n},0,nominal,{won},h\n" for n in range(20))
        (tmp_path / f"{arm}.csv").write_text(HEADER + rows)
    old, new = tmp_path / "old.csv", tmp_path / "new.csv"
    said = refused([f"new={old}", f"old={new}"], tmp_path)
    assert "line 2: the file says arm 'old' and the command line 'new'" in said
    said = refused([f"old@shared={old}", f"new@shared={new}"], tmp_path)
    assert "the file says condition 'nominal' and the command line 'shared'" in said
    assert judged([f"old={old}", f"new@nominal={new}"], tmp_path).record.effects[0].sign == 1


def test_a_label_names_the_arm_of_a_model_that_is_no_arm(tmp_path: Path) -> None:
    logs = [inspect_log(tmp_path / f"{arm}.eval", "gpt", WON) for arm in ("a", "b")]
    labelled = [f"old={logs[0]}", f"new={logs[1]}"]
    assert judged(labelled, tmp_path).record.question.repair == "new"
    logs = [inspect_log(tmp_path / f"{arm}.eval", arm, WON) for arm in ("old", "new")]
    said = refused([f"new={logs[0]}", f"old={logs[1]}"], tmp_path / "other")
    assert "the file says arm 'old' and the command line 'new'" in said


@pytest.mark.parametrize("method", [zipfile.ZIP_BZIP2, zipfile.ZIP_LZMA])
@pytest.mark.parametrize("cut", [0, 9])
def test_a_log_packed_by_another_method_is_refused(method: int, cut: int, tmp_path: Path) -> None:
    """Python unpacks these without a bound; damaged ones ended in a traceback."""
    path = tmp_path / "old.eval"
    with zipfile.ZipFile(path, "w", method) as archive:
        archive.writestr("header.json", json.dumps({"eval": {"task": "t", "model": "old"}}))
    data = bytearray(path.read_bytes())
    data[60 : 60 + cut] = bytes(cut)
    path.write_bytes(data)
    assert "header.json is not packed as Inspect packs its logs" in refused(path, tmp_path)


@pytest.mark.parametrize("kind", ["old.eval", "old.new.eval"])
def test_a_log_that_is_cut_short_is_one_sentence(kind: str, tmp_path: Path) -> None:
    data = Path(inspect_log(tmp_path / kind, "old", WON)).read_bytes()
    for at in range(1, len(data), 101):
        (tmp_path / "cut.eval").write_bytes(data[:at])
        assert "cut.eval: is no sound zip file" in refused(tmp_path / "cut.eval", tmp_path)
    (tmp_path / "cut.eval").write_bytes(lzma.compress(data))
    assert "is no sound zip file" in refused(tmp_path / "cut.eval", tmp_path)


def test_a_small_log_does_not_fill_the_memory(tmp_path: Path) -> None:
    path = tmp_path / "old.eval"
    for texts, says in (
        ([b'"' + b"x" * 2**27 + b'"'], "samples/0.json unpacks to more than 64 MiB"),
        ([b'"' + b"x" * 2**25 + b'"'] * 9, "unpacks to more than 256 MiB; give it in parts"),
    ):
        with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
            archive.writestr("header.json", json.dumps({"eval": {"task": "t", "model": "old"}}))
            for n, text in enumerate(texts):
                archive.writestr(f"samples/{n}.json", text)
        before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        assert says in refused(path, tmp_path)
        assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 2**16  # KiB


@pytest.mark.parametrize("store_schema", [True, False])
@pytest.mark.parametrize(("rows", "letters"), [(2**25, 1), (2**10, 2**19)])
def test_a_small_table_does_not_fill_the_memory(
    rows: int, letters: int, store_schema: bool, tmp_path: Path
) -> None:
    """Columns of equal cells take no room in a file, long texts among them."""
    which, path = np.zeros(rows, np.int32), tmp_path / "a.parquet"
    column = pa.DictionaryArray.from_arrays(which, pa.array(["x" * letters]))
    pq.write_table(pa.table({"arm": column}), path, compression="zstd", store_schema=store_schema)
    data = path.read_bytes()
    assert len(data) < 2**20
    with pytest.raises(Unreadable, match="it unpacks to more than 256 MiB"):
        read_table(data)
    with pytest.raises(Unreadable, match="it unpacks to more than 256 MiB"):
        list(read_rows(data))
    said = refused(tmp_path / "a.parquet", tmp_path)
    assert "256 MiB" in said or "has no success" in said or "names no scene" in said


def test_names_that_are_no_text_are_a_damaged_table(tmp_path: Path) -> None:
    data = pa.Array.from_buffers(
        pa.string(), 1, [None, pa.py_buffer(b"\0\0\0\0\2\0\0\0"), pa.py_buffer(b"\xff\xfe")]
    )
    pq.write_table(pa.table({"arm": data, "scene": ["s"], "success": [1]}), tmp_path / "a.parquet")
    assert "a.parquet: cannot be read" in refused(tmp_path / "a.parquet", tmp_path)


def test_lm_eval_samples_are_still_read(tmp_path: Path) -> None:
    files = [f"{arm}{lm_eval(tmp_path / arm, WON)}" for arm in ("old", "new")]
    run = judged(files, tmp_path, columns=["success=exact_match,strict-match"])
    assert run.record.scenes == 12
