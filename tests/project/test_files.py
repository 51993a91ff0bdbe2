"""What holds for every file that the project tracks."""

import re
from contextlib import suppress
from pathlib import Path

import pytest

MAX_BYTES = 20_000_000
MAX_LINES = 400

# Written in pieces, so that this file passes its own test.
REGISTRY_HOSTS = [
    *("py" + "pi.org", "python" + "hosted.org", "npm" + "js.org", "ana" + "conda.org"),
    *("deb.deb" + "ian.org", "download.py" + "torch.org"),
]
REGISTRY_HOST = re.compile("|".join(map(re.escape, REGISTRY_HOSTS)))
MACHINE_DIRECTORIES = ["wo" + "rk", "ro" + "ot", "ho" + "me", "Us" + "ers", "op" + "t"]
MACHINE_PATH = re.compile(rf"(?<![\w.~/}}])/(?:{'|'.join(MACHINE_DIRECTORIES)})/\w")


@pytest.fixture(scope="module")
def texts(tracked: list[Path]) -> dict[Path, str]:
    texts: dict[Path, str] = {}
    for path in tracked:
        with suppress(UnicodeDecodeError):
            texts[path] = path.read_text(encoding="utf-8")
    return texts


def test_no_file_is_above_20_megabytes(tracked: list[Path]) -> None:
    assert [path for path in tracked if path.stat().st_size > MAX_BYTES] == []


def test_every_source_file_is_under_400_lines(texts: dict[Path, str]) -> None:
    lengths = {path: text.count("\n") for path, text in texts.items() if path.suffix == ".py"}
    assert {path: lines for path, lines in lengths.items() if lines >= MAX_LINES} == {}


@pytest.mark.parametrize("pattern", [REGISTRY_HOST, MACHINE_PATH])
def test_no_file_names_a_registry_or_a_path_of_one_machine(
    pattern: re.Pattern[str], texts: dict[Path, str]
) -> None:
    named = {path: pattern.findall(text) for path, text in texts.items()}
    assert {path: names for path, names in named.items() if names} == {}
