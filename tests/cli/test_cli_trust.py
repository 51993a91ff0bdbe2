"""Code that a received folder or file names runs only where a person says so."""

import hashlib
import shutil
import sys
from pathlib import Path

import pytest
from cli_runs import ROOT, audit, edit, faultpath
from odd_inputs import sign

from faultpath.core.errors import UserError
from faultpath.trials import SystemSpec
from faultpath.trials.trust import ReceivedCode

MINE = f"""
import sys
sys.path.append({str(ROOT / "examples")!r})
from pathlib import Path
from toy import Toy
Path("imported").touch()

def create() -> Toy:
    return Toy()
"""


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A finished run of a system beside it."""
    place = tmp_path_factory.mktemp("trust")
    with pytest.MonkeyPatch.context() as patched:
        patched.chdir(place)
        patched.setattr(sys, "path", list(sys.path))
        (place / "mine.py").write_text(MINE)
        assert audit(system="mine.py:create", out="run", scenes=2).status == 0
        (place / "imported").unlink()
    return place


@pytest.fixture(autouse=True)
def _here(run: Path, tmp_path: Path) -> None:
    shutil.copytree(run, tmp_path, dirs_exist_ok=True)


def renamed(**names: object) -> None:
    """Let the record name another system, and fit its digest as a stranger would."""
    edit(Path("run/record.json"), lambda record: record["question"].update(names))
    sign(Path("run"))


@pytest.mark.parametrize("trust", [(), ("--trust",)])
@pytest.mark.parametrize(
    ("system", "options"),
    [
        ("os:system", {"command": "touch ran"}),
        ("signal:pause", {}),
    ],
)
def test_a_function_that_builds_nothing_is_called_for_no_file(system, options, trust) -> None:
    renamed(system=system, options=options)
    ended = faultpath("replay", "run", *trust)
    assert ended.status == 2
    assert system.partition(":")[0] in ended.err
    assert ("nothing else is called" if trust else "give --trust") in ended.err
    assert "it is the code of the run" not in ended.err
    assert not Path("ran").exists()
    assert not Path("runs").exists()


def test_a_file_is_shown_and_imported_where_it_is_trusted() -> None:
    before = list(sys.path)
    digest = hashlib.sha256(Path("mine.py").read_bytes()).hexdigest()[:16]
    said = faultpath("replay", "run").refused(str(Path("mine.py").resolve()), digest)
    assert "changed since" not in said
    assert sys.path == before
    assert not Path("imported").exists()
    trusted = faultpath("replay", "run", "--trust")
    assert trusted.status == 0, trusted.err
    assert "Importing mine.py:create" in " ".join(trusted.out.split())
    assert Path("imported").exists()


def test_that_the_code_is_another_is_said_before_it_is_imported() -> None:
    code = "\nif not Path('said').exists():\n    raise SystemExit\n"
    Path("mine.py").write_text(MINE + code)
    faultpath("replay", "run").refused("not the code of the run (mine.py changed since)")
    assert not Path("imported").exists()
    ended = faultpath("replay", "run", "--trust")
    assert "This is not the code of the run (mine.py changed since)." in ended.out


@pytest.mark.parametrize(
    "names",
    [
        {"options": {"plant": "mine.py:create"}},
        {"options": {"bring": "mine.py:create "}},
        {"options": {"bring": "gru, mine.py:écrire"}},
        {"options": {"predictor": "mine.py:create.x"}},
        {"options": {"estimator": "mine.py:a-b"}},
        {"options": {"planner": "wm-a-wind/mine.py:create"}},
        {"system": "faultpath.api.systems:load_system", "options": {"system": "mine.py"}},
    ],
)
def test_a_part_that_a_file_brings_to_an_installed_system_is_asked_for_too(names) -> None:
    pytest.importorskip("faultpath_quadrotor")
    renamed(**{"system": "quadrotor"} | names)
    digest = hashlib.sha256(Path("mine.py").read_bytes()).hexdigest()[:16]
    faultpath("replay", "run").refused("give --trust", digest)
    assert not Path("imported").exists()


def test_the_file_that_is_shown_is_the_one_that_would_be_imported() -> None:
    pytest.importorskip("faultpath_quadrotor")
    Path("decoy.py").write_text("")
    Path("decoy.py:create").mkdir()
    shutil.copy("mine.py", "decoy.py:create/real.py")
    options = {"planner": "decoy.py:create/real.py:run-it"}
    renamed(system="quadrotor", options=options)
    real = Path("decoy.py:create/real.py").resolve()
    faultpath("replay", "run").refused(str(real))


@pytest.mark.parametrize(
    "names", [{"system": "a\0b.py:create"}, {"options": {"bring": "a\0b.py:create"}}]
)
@pytest.mark.parametrize("trust", [(), ("--trust",)])
def test_a_name_with_a_zero_byte_is_refused_in_a_sentence(names, trust) -> None:
    pytest.importorskip("faultpath_quadrotor")
    renamed(**{"system": "quadrotor"} | names)
    assert faultpath("replay", "run", *trust).status == 2


def test_an_installed_system_needs_no_word_and_a_changed_part_is_told() -> None:
    pytest.importorskip("faultpath_quadrotor")
    said: list[str] = []
    spec = SystemSpec(name="quadrotor", options={"bring": "mine.py:create"})
    ReceivedCode("record.json", True, said.append, {"mine": "0" * 64}).check(spec, ())
    assert "mine.py:create" in said[-1]
    assert "changed since" in said[-1]
    said.clear()
    file = ReceivedCode("record.json", False, said.append)
    file.check(SystemSpec(name="quadrotor", options={"wind": "L3"}), ("gru", "gru+dcc"))
    assert said == ["Importing quadrotor, which record.json names."]
    with pytest.raises(UserError, match="give --trust"):
        file.check(SystemSpec(name="quadrotor"), ("mine.py:create/gru", "gru"))
    with pytest.raises(UserError, match="no file found"):
        file.check(SystemSpec(name="sys:exit"), ())
