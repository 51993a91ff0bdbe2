"""From a name to a system."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from faultpath.errors import UserError
from faultpath.trials import SystemSpec, load_system

FILE = Path(__file__).parents[1] / "execution" / "toy_system.py"


def test_a_file_is_enough(tmp_path, monkeypatch):
    system = load_system(SystemSpec(name=f"{FILE}:create", options={"fingerprint": "x"}))
    assert (system.name, system.fingerprint()) == ("toy", "x")
    monkeypatch.chdir(FILE.parent)
    assert load_system(SystemSpec(name="./toy_system.py:create")).name == "toy"


def test_a_file_may_import_the_file_beside_it(tmp_path, monkeypatch):
    monkeypatch.setattr(sys, "path", list(sys.path))
    (tmp_path / "parts_of_mine.py").write_text(FILE.read_text())
    (tmp_path / "mine.py").write_text("from parts_of_mine import create\n")
    assert load_system(SystemSpec(name=f"{tmp_path}/mine.py:create")).name == "toy"


def test_a_module_of_the_working_directory_is_found(tmp_path, monkeypatch):
    monkeypatch.setattr(sys, "path", [p for p in sys.path if p not in ("", os.getcwd())])
    (tmp_path / "module_of_mine.py").write_text(FILE.read_text())
    monkeypatch.chdir(tmp_path)
    assert load_system(SystemSpec(name="module_of_mine:create")).name == "toy"


@pytest.mark.parametrize(
    ("name", "sentence"),
    [
        ("octopus", "there is no system 'octopus': use quadrotor"),
        ("no_such_module:create", "there is no module 'no_such_module'"),
        ("faultpath.absent:create", r"there is no module 'faultpath\.absent'"),
        ("no/such/file.py:create", r"there is no file 'no/such/file\.py'"),
        (f"{FILE}:absent", "has no function 'absent'"),
        (f"{FILE}:STEPS", "has no function 'STEPS'"),
        (f"{FILE}:impostor", "returned a object"),
        (f"{FILE}:needy", r"pip install 'faultpath\[quadrotor\]'"),
        (f"{FILE}:", "there is no system"),
        ("..x:create", "there is no system"),
    ],
)
def test_a_name_that_leads_nowhere_says_what_to_do(name, sentence):
    with pytest.raises(UserError, match=sentence):
        load_system(SystemSpec(name=name))


def test_an_option_that_the_factory_does_not_take_is_named():
    with pytest.raises(UserError, match=r"'colour'.*it takes none"):
        load_system(SystemSpec(name=f"{FILE}:impostor", options={"colour": "red"}))


def test_naming_a_system_imports_no_torch():
    code = (
        "import sys, faultpath.execution, faultpath.store, faultpath.trials;"
        "sys.exit('torch' in sys.modules)"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
