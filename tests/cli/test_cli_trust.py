"""Code that a received folder or file names runs only where a person says so."""

import shutil
import sys
from contextlib import nullcontext
from pathlib import Path
from typing import Any

import pytest
from cli_runs import audit, edit, faultpath
from odd_inputs import sign
from written import CREATE, written

from faultpath.api.systems import check_named
from faultpath.core.errors import UserError
from faultpath.run.plan import SystemSpec


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A finished run of a system beside it."""
    place = tmp_path_factory.mktemp("trust")
    with pytest.MonkeyPatch.context() as patched:
        patched.chdir(place)
        patched.setattr(sys, "path", list(sys.path))
        written(place, create=f'Path("imported").touch()\n{CREATE}')
        assert audit(system="mine.py:create", out="run", scenes=2).status == 0
        (place / "imported").unlink()
    return place


@pytest.fixture(autouse=True)
def _here(run: Path, tmp_path: Path) -> None:
    shutil.copytree(run, tmp_path, dirs_exist_ok=True)


def renamed(**names: object) -> None:
    """Let the record name another system, and fit its digest as a stranger would."""

    def change(record: dict[str, Any]) -> None:
        for name, value in names.items():
            record["facts" if name == "system" else "question"][name] = value

    edit(Path("run/record.json"), change)
    sign(Path("run"))


@pytest.mark.parametrize("trust", [(), ("--trust",)])
def test_a_function_that_builds_nothing_is_called_for_no_file(trust) -> None:
    renamed(system="os:system", options={"command": "touch ran"})
    ended = faultpath("replay", "run", *trust)
    assert ended.status == 2
    assert "os" in ended.err
    assert ("nothing else is called" if trust else "give --trust") in ended.err
    assert not Path("ran").exists()
    assert not Path("runs").exists()


def test_a_file_is_imported_where_a_person_names_it_too_or_trusts_all() -> None:
    before = list(sys.path)
    for code in ((), ("--code", "other.py"), ("--code", "mine.py:other")):
        sentence = faultpath("replay", "run", *code).refused("record.json names mine.py:create")
        assert "run the command with --code mine.py:create, or give --trust" in sentence
        assert not Path("imported").exists()
    assert sys.path == before
    for code in (("--code", "mine.py"), ("--code", "mine.py:create"), ("--trust",)):
        ended = faultpath("replay", "run", *code)
        assert ended.status == 0, ended.err
        assert Path("imported").exists()


def test_that_the_code_is_another_is_said_where_trials_differ() -> None:
    with Path("mine.py").open("a") as file:
        file.write("Toy.control_dt_s = 2 * Toy.control_dt_s\n")
    ended = faultpath("replay", "run", "--code", "mine.py")
    assert ended.status == 1, ended.err
    assert "mine.py" in ended.out.rpartition("have changed: ")[2]


@pytest.mark.parametrize(
    "names",
    [
        {"options": {"plant": "mine.py:create"}},
        {"options": {"bring": "mine.py:create "}},
        {"options": {"bring": "gru, mine.py:écrire"}},
        {"options": {"predictor": "mine.py:create.x"}},
        {"options": {"estimator": "mine.py:a-b"}},
        {"options": {"planner": "wm-a-wind/mine.py:create"}},
        {"options": {"bring": "a\0mine.py:create"}},
        {"system": "a\0mine.py:create"},
        {"system": "faultpath.api.systems:load_system", "options": {"system": "mine.py"}},
    ],
)
def test_a_part_that_a_file_brings_to_an_installed_system_is_asked_for_too(names) -> None:
    pytest.importorskip("faultpath_quadrotor")
    renamed(**{"system": "quadrotor"} | names)
    faultpath("replay", "run", "--code", "quadrotor").refused("mine.py", "give --trust")
    assert not Path("imported").exists()


@pytest.mark.parametrize(
    "names", [{"system": "a\0b.py:create"}, {"options": {"bring": "a\0b.py:create"}}]
)
def test_a_name_with_a_zero_byte_is_refused_whoever_trusts_it(names) -> None:
    pytest.importorskip("faultpath_quadrotor")
    renamed(**{"system": "quadrotor"} | names)
    faultpath("replay", "run", "--trust").refused()


@pytest.mark.parametrize(
    ("system", "options", "variants", "code", "refused"),
    [
        ("quadrotor", {"wind": "L3"}, ("gru", "gru+dcc"), (), ""),
        ("quadrotor", {}, ("mine.py:create/gru", "gru"), (), "mine.py:create"),
        ("quadrotor", {}, ("mine.py:create/gru", "gru"), ("mine.py",), ""),
        ("quadrotor", {"bring": "a.py:x,b.py:y"}, (), ("a.py:x",), "b.py:y"),
        ("quadrotor", {"planner": "a.py:x/b.py:run-it"}, (), ("a.py:x",), "a.py:x/b.py:run-it"),
        ("sys:exit", {}, (), (), "sys:exit"),
        ("sys:exit", {}, (), ("sys:exit",), ""),
    ],
)
def test_each_name_of_code_has_to_be_named_too(system, options, variants, code, refused) -> None:
    pytest.importorskip("faultpath_quadrotor")
    spec = SystemSpec(name=system, options=options)
    with pytest.raises(UserError, match=f"names {refused}, and") if refused else nullcontext():
        check_named("record.json", spec, variants, code, trusted=False)
    check_named("record.json", spec, variants, (), trusted=True)
