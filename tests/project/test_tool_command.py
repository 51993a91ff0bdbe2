"""Tools that have the command fill a new folder."""

from pathlib import Path
from types import ModuleType

import pytest

TOOLS = Path(__file__).resolve().parents[2] / "tools"


@pytest.fixture
def command(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    monkeypatch.syspath_prepend(str(TOOLS))
    import command

    return command


def test_a_folder_that_is_new_is_named(command: ModuleType, tmp_path: Path) -> None:
    assert command.new_folder("Fly.", [str(tmp_path / "new")]) == tmp_path / "new"


def test_one_that_exists_is_refused_in_a_sentence(
    command: ModuleType, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit) as ended:
        command.new_folder("Fly.", [str(tmp_path)])
    assert ended.value.code == 2
    assert f"{tmp_path} exists: name a folder that is new" in capsys.readouterr().err


def test_a_tool_ends_as_the_command_did(command: ModuleType) -> None:
    command.faultpath("--version")
    with pytest.raises(SystemExit) as ended:
        command.faultpath("audit", "no-such-system")
    assert ended.value.code == 2
