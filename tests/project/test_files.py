"""What holds for every file that the project tracks."""

import re
from pathlib import Path

MAX_BYTES = 20_000_000
MAX_LINES = 400

# Written in pieces, so that this file passes its own test.
REGISTRY_HOSTS = [
    "py" + "pi.org",
    "python" + "hosted.org",
    "npm" + "js.org",
    "ana" + "conda.org",
    "deb.deb" + "ian.org",
    "download.py" + "torch.org",
]
MACHINE_DIRECTORIES = ["wo" + "rk", "ro" + "ot", "ho" + "me", "Us" + "ers", "op" + "t"]
MACHINE_PATH = re.compile(rf"(?<![\w.~/}}])/(?:{'|'.join(MACHINE_DIRECTORIES)})/\w")


def _text(path: Path) -> str | None:
    try:
        return path.read_text(encoding="utf-8")
    except UnicodeDecodeError:
        return None


def test_no_file_is_above_20_megabytes(tracked: list[Path]) -> None:
    assert [path for path in tracked if path.stat().st_size > MAX_BYTES] == []


def test_every_source_file_is_under_400_lines(tracked: list[Path]) -> None:
    sources = [path for path in tracked if path.suffix == ".py"]
    lengths = {path: len(path.read_text(encoding="utf-8").splitlines()) for path in sources}
    assert {path: lines for path, lines in lengths.items() if lines >= MAX_LINES} == {}


def test_no_file_names_a_package_registry(tracked: list[Path]) -> None:
    named = [
        (path, host)
        for path in tracked
        if (text := _text(path)) is not None
        for host in REGISTRY_HOSTS
        if host in text
    ]
    assert named == []


def test_no_file_holds_a_path_of_one_machine(tracked: list[Path]) -> None:
    found = [
        (path, match.group())
        for path in tracked
        if (text := _text(path)) is not None
        for match in MACHINE_PATH.finditer(text)
    ]
    assert found == []
