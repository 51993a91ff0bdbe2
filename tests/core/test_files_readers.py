"""Every reader of files that somebody names, against what is no file and what is no plain data."""

import os
import signal
from collections.abc import Callable, Iterator
from importlib import import_module
from pathlib import Path
from typing import Any

import pytest
from no_files import THINGS

from faultpath.core.errors import UserError
from faultpath.core.files.atomic import locked
from faultpath.core.files.opening import contents, read_regular
from faultpath.core.files.parquet import Unreadable
from faultpath.core.files.plain import Misread, read_json, read_yaml
from faultpath.interface import read_interface
from faultpath.learning.model_card import FitRecord, read_card
from faultpath.run.store.folder import RunFolder, read_manifest, read_outcomes

Read = Callable[[Path], object]


def _named(place: str) -> Any:
    """Return a function of a package that may be missing, by `module:name`."""
    module, _, name = place.partition(":")
    return getattr(import_module(module), name)


def _card(path: Path) -> object:
    return read_card(path, _named("faultpath_quadrotor.models:ModelCard"))


def _shard(path: Path) -> object:
    folder = RunFolder(path.parents[1])
    return folder.load_shard(path.name.partition("-")[0], (), lambda notice: None)


SCENES = "faultpath_quadrotor.scenes.library:load_library"
EVIDENCE = "faultpath_paper.evidence.table:read_evidence"
RESULTS = "faultpath_paper.run:read_results"
READERS: dict[str, tuple[str, Read]] = {
    "interface": ("toy.yaml", read_interface),
    "library of scenes": ("mine.json", lambda path: _named(SCENES)(path)),
    "card of a model": ("model.json", _card),
    "record of a fit": ("fit.json", lambda path: read_card(path, FitRecord)),
    "manifest": ("manifest.json", read_manifest),
    "any file of a run": ("record.json", read_regular),
    "outcomes": ("outcomes.parquet", read_outcomes),
    "evidence": ("evidence.parquet", lambda path: _named(EVIDENCE)(path)),
    "reproduction": ("reproduction.json", lambda path: _named(RESULTS)(path.parent)),
    "shard": ("shards/key-digest.parquet", _shard),
}
"""By what it reads: the name of the file, and the reader."""


@pytest.fixture(autouse=True)
def _in_time() -> Iterator[None]:
    """End what would wait for ever."""

    def stop(*_: object) -> None:
        raise AssertionError("it does not end")

    before = signal.signal(signal.SIGALRM, stop)
    signal.alarm(30)
    yield
    signal.alarm(0)
    signal.signal(signal.SIGALRM, before)


@pytest.mark.parametrize("thing", THINGS)
@pytest.mark.parametrize("reader", READERS)
def test_what_is_no_file_is_refused_in_one_sentence(
    reader: str, thing: str, tmp_path: Path
) -> None:
    name, read = READERS[reader]
    path = tmp_path / name
    path.parent.mkdir(exist_ok=True)
    THINGS[thing](path)
    with pytest.raises((UserError, Unreadable)) as caught:
        read(path)
    assert "\n" not in str(caught.value)
    assert path.exists()


def test_the_lock_of_a_folder_is_a_file(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / ".lock")
    with pytest.raises(UserError, match=r"\.lock is a pipe"), locked(tmp_path, lambda notice: None):
        raise AssertionError("it is locked")


def test_a_file_is_read_up_to_a_size(tmp_path: Path) -> None:
    path = tmp_path / "large"
    with path.open("wb") as file:
        file.truncate(10 * 2**30)  # takes no room
    with pytest.raises(OSError, match="larger than 4 GiB"):
        contents(path)
    path.write_bytes(b"four")
    assert contents(path, most=4) == b"four"
    with pytest.raises(OSError, match="larger than"):
        contents(path, most=3)
    with pytest.raises(OSError, match="nothing can have that name"):
        contents("a\0b")


BOTH: dict[bytes, str] = {
    b'{"a": 1e999}': "out of range",
    b'{"a": ' + b"9" * 5000 + b"}": "out of range",
    b'{"a": 1, "a": 2}': "appears twice",
    b"[" * 100_000: "nested too deeply",
    b"\xff\xfe{}": "not UTF-8",
    b'{"a": 1e-400}': "does not round to it",
    b'{"a":\n"\0"}': "null character",
    b"{": "is not",
}
YAML: dict[bytes, str] = {
    b"a: .inf": "out of range",
    b"a: .nan": "out of range",
    b"a: &x [1]\nb: *x": "aliases",
    b"a: !!bool 7": "tags",
    b"? [1]\n: 2": "a key is no text",
    b"a: 1\n---\nb: 2": "not plain YAML",
    b"#" * 1_000_001: "too long",
}
JSON: dict[bytes, str] = {
    b'{"a": NaN}': "no number",
    b'{"a": -Infinity}': "no number",
    '{"a": ٣}'.encode(): "not JSON",
    b"": "not JSON",
}


@pytest.mark.parametrize(
    ("read", "data", "sentence"),
    [(read_yaml, *each) for each in (BOTH | YAML).items()]
    + [(read_json, *each) for each in (BOTH | JSON).items()],
)
def test_what_is_not_plain_is_refused(read: Callable[[bytes], object], data: bytes, sentence: str):
    with pytest.raises(Misread, match=sentence) as caught:
        read(data)
    assert "\n" not in str(caught.value)


def test_what_is_not_plainly_a_number_is_text() -> None:
    for text in ("0x10", "1_0", "1:30", "007", "٣", "2001-99-99", "½", "١٫٥", "1e", "e1", "--1"):
        assert read_yaml(f"a: {text}".encode()).data == {"a": text}
    numbers = {"1e-3": 1e-3, "-0": 0, "+7": 7, ".5": 0.5, "1.": 1.0, "-1.5E+3": -1500.0}
    for text, number in numbers.items():
        assert read_yaml(f"a: {text}".encode()).data == {"a": number}


def test_a_byte_order_mark_is_no_part_of_a_text() -> None:
    for read in (read_json, lambda data: read_yaml(data).data):
        assert read(b"\xef\xbb\xbf{}") == {}
