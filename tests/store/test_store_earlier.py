"""Folders named after a question and the code that flew it."""

from pathlib import Path

import pytest

from faultpath.code import CodeState
from faultpath.store.manifest import keyed


def _code(text: str) -> CodeState:
    return CodeState(files={"my.py": text}, packages={}, python="3")


def test_another_code_gets_another_folder_and_a_sentence(tmp_path: Path) -> None:
    assert keyed(tmp_path / "runs", "a", _code("1"))[1] == ""
    first, _ = keyed(tmp_path, "a", _code("1"))
    first.mkdir()
    assert keyed(tmp_path, "a", _code("1")) == (first, "")
    assert keyed(tmp_path, "b", _code("2"))[1] == ""
    second, said = keyed(tmp_path, "a", _code("2"))
    assert second != first
    assert said.startswith(f"The code has changed since {first}: that run is kept")
    assert said.endswith(f"starts anew in {second}.")


@pytest.mark.parametrize("name", ["a-00000000.txt", "a-zzzzzzzz", "ab-00000000", "a"])
def test_other_folders_are_not_taken_for_runs(name: str, tmp_path: Path) -> None:
    (tmp_path / name).mkdir()
    assert keyed(tmp_path, "a", _code("1"))[1] == ""
