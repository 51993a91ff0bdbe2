"""From a name to a system."""

import json
import os
import py_compile
import subprocess
import sys
from pathlib import Path

import pytest

from faultpath.core import error_source as blame
from faultpath.core.errors import UserError
from faultpath.run.plan import SystemSpec
from faultpath.run.registry import load_system

ROOT = Path(__file__).resolve().parents[2]
FILE = ROOT / "tests" / "toys" / "weighed.py"


def test_a_file_is_enough_and_may_import_the_file_beside_it(tmp_path, monkeypatch):
    (tmp_path / "parts_of_mine.py").write_text(FILE.read_text())
    (tmp_path / "mine.py").write_text("from parts_of_mine import create\n")
    monkeypatch.chdir(tmp_path)
    system = load_system(SystemSpec(name="./mine.py:create", options={"fingerprint": "x"}))
    assert (system.name, system.fingerprint()) == ("toy", "x")


def test_what_is_loaded_by_mistake_is_blamed_for_nothing():
    with pytest.raises(UserError, match="does not declare that 'loads'"):
        load_system(SystemSpec(name="json:loads", options={"s": "{}"}))
    with pytest.raises(ValueError, match="Expecting") as found:
        json.loads("nothing")
    assert blame.location(found.value).startswith(os.path.relpath(__file__))


@pytest.mark.parametrize("edited", ["mine.py", "parts_of_mine.py"])
def test_two_edits_within_a_second_are_two(tmp_path, edited):
    """Python takes compiled code of a file with the same time in seconds and the same size."""
    (tmp_path / "parts_of_mine.py").write_text(f"{FILE.read_text()}\nSAID = 'a'\n")
    text = "from parts_of_mine import SAID, create as made\nLED = 'a'\n"
    text += "def create() -> 'System': return made(fingerprint=SAID + LED)\n"
    (tmp_path / "mine.py").write_text(text)
    for stem in ("mine", "parts_of_mine"):
        file = tmp_path / f"{stem}.py"
        os.utime(file, (1e9, 1e9))
        py_compile.compile(str(file))
        if file.name == edited:
            file.write_text(file.read_text().replace("= 'a'", "= 'b'"))
            os.utime(file, (1e9, 1e9))
    code = "import sys; from faultpath.run.plan import SystemSpec\n"
    code += "from faultpath.run.registry import load_system\n"
    code += "print(load_system(SystemSpec(name=sys.argv[1])).fingerprint())"
    asked = [sys.executable, "-c", code, f"{tmp_path}/mine.py:create"]
    done = subprocess.run(asked, capture_output=True, text=True, check=True)
    assert sorted(done.stdout.strip()) == ["a", "b"]


@pytest.mark.parametrize(
    ("name", "sentence"),
    [
        ("octopus", "there is no system 'octopus'; installed: quadrotor"),
        ("no_such_module:create", "there is no module 'no_such_module'"),
        ("faultpath.absent:create", r"there is no module 'faultpath\.absent'"),
        ("no/such/file.py:create", r"there is no file 'no/such/file\.py'"),
        (f"{FILE}:absent", "has no function 'absent'"),
        (f"{FILE}:READERS", "has no function 'READERS'"),
        (f"{FILE}:impostor", "returned a object"),
        (f"{FILE}:needy", r"pip install '\.\[torch\]'"),
        (f"{FILE}:", "there is no system"),
        (str(FILE.with_suffix("")), rf"; did you mean '{FILE}'\? installed: "),
        ("..x:create", "there is no system"),
    ],
)
def test_a_name_that_leads_nowhere_says_what_to_do(name, sentence):
    with pytest.raises(UserError, match=sentence):
        load_system(SystemSpec(name=name))


def _systems(tmp_path: Path, *names: str) -> list[Path]:
    """Folders of systems that each have a `helper_of_mine.py` of their own."""
    for name in names:
        folder = tmp_path / name
        folder.mkdir()
        (folder / "helper_of_mine.py").write_text(f"WHO = {name!r}\n")
        text = FILE.read_text() + "\nfrom helper_of_mine import WHO\nToySystem.name = WHO\n"
        (folder / "mine.py").write_text(text)
    return [tmp_path / name for name in names]


@pytest.fixture
def own_modules(monkeypatch, tmp_path_factory):
    """Leave neither modules nor places to look for them to other tests."""
    # Fixtures with a wider scope leave the folders of their systems on the path.
    others = str(tmp_path_factory.getbasetemp())
    monkeypatch.setattr(sys, "path", [path for path in sys.path if not path.startswith(others)])
    before = dict(sys.modules)
    yield
    for name in set(sys.modules) - set(before):
        del sys.modules[name]


@pytest.mark.usefixtures("own_modules")
@pytest.mark.parametrize("late", [False, True], ids=["imported at once", "imported later"])
def test_a_second_system_does_not_run_the_helper_of_the_first(tmp_path, late):
    first, second = _systems(tmp_path, "first", "second")
    if late:
        imports = "\ndef later():\n    from helper_of_mine import WHO\n    return WHO\n"
        (first / "mine.py").write_text(FILE.read_text() + imports)
    load_system(SystemSpec(name=f"{first}/mine.py:create"))
    assert ("helper_of_mine" in sys.modules) != late
    path, modules = list(sys.path), dict(sys.modules)
    with pytest.raises(UserError, match="imports 'helper_of_mine'") as refused:
        load_system(SystemSpec(name=f"{second}/mine.py:create"))
    for each in (first, second):
        assert str(each / "helper_of_mine.py") in str(refused.value)
    assert (sys.path, sys.modules) == (path, modules)


@pytest.mark.usefixtures("own_modules")
def test_a_module_of_a_folder_left_behind_is_not_taken_for_the_one_here(tmp_path, monkeypatch):
    for folder in _systems(tmp_path, "first", "second"):
        monkeypatch.chdir(folder)
        if folder.name == "first":
            assert load_system(SystemSpec(name="mine:create")).name == "first"
        else:
            with pytest.raises(UserError, match=r"imports '(helper_of_)?mine'"):
                load_system(SystemSpec(name="mine:create"))


@pytest.mark.usefixtures("own_modules")
def test_two_systems_in_files_of_one_name(tmp_path):
    systems = []
    for name in ("first", "second"):
        (tmp_path / name).mkdir()
        file = tmp_path / name / "mine.py"
        file.write_text(FILE.read_text() + f"\nToySystem.name = {name!r}\n")
        systems.append(load_system(SystemSpec(name=f"{file}:create")))
    assert [system.name for system in systems] == ["first", "second"]
    for system in systems:
        assert sys.modules[type(system).__module__].ToySystem is type(system)


@pytest.mark.usefixtures("own_modules")
def test_a_system_that_fails_to_load_leaves_nothing_and_may_be_corrected(tmp_path):
    (folder,) = _systems(tmp_path, "first")
    good = (folder / "mine.py").read_text()
    (folder / "mine.py").write_text(good + "\n1 / 0\n")
    path, modules = list(sys.path), dict(sys.modules)
    with pytest.raises(ZeroDivisionError):
        load_system(SystemSpec(name=f"{folder}/mine.py:create"))
    assert (sys.path, sys.modules) == (path, modules)
    (folder / "mine.py").write_text(good)
    (folder / "helper_of_mine.py").write_text("WHO = 'corrected'\n")
    assert load_system(SystemSpec(name=f"{folder}/mine.py:create")).name == "corrected"


@pytest.mark.parametrize(
    ("factory", "builds"),
    [
        ("def create() -> System: return Toy()", True),
        ("def create() -> 'Toy': return Toy()", True),
        ("del System\ndef create() -> 'System': return Toy()", True),
        ("import functools\n@functools.cache\ndef create() -> System: return Toy()", True),
        ("create = Toy", True),
        ("def create(): return Toy()", False),
        ("def create() -> None: ran()", False),
        ("def create() -> 'System | None': return Toy()", False),
        ("def create() -> 'Absent': return Toy()", False),
        ("class create:\n    def __init__(self): ran()", False),
        ("import functools\ncreate = functools.partial(ran)", False),
    ],
)
def test_only_what_is_declared_to_build_a_system_is_called(factory, builds, tmp_path):
    (tmp_path / "mine.py").write_text(
        f"import sys\nsys.path.append({str(FILE.parent)!r})\nfrom pathlib import Path\n"
        "from faultpath import System\nfrom weighed import ToySystem as Toy\n"
        f"def ran(): Path({str(tmp_path / 'ran')!r}).touch()\n{factory}\n"
    )
    spec = SystemSpec(name=f"{tmp_path}/mine.py:create")
    if builds:
        assert load_system(spec).name == "toy"
    else:
        with pytest.raises(
            UserError, match=r"annotate it, as in `def create\(\.\.\.\) -> System:`"
        ):
            load_system(spec)
    assert not (tmp_path / "ran").exists()


@pytest.mark.parametrize(
    ("imports", "annotation"),
    [
        ("from faultpath.system import ComposedSystem", "ComposedSystem"),
        ("from faultpath.system import ComposedSystem\nfrom faultpath import System", "System"),
        ("import faultpath.system", '"System"'),
    ],
)
def test_the_annotation_that_is_advised_works_in_that_file(imports, annotation, tmp_path):
    file = tmp_path / "mine.py"
    file.write_text(f"{imports}\n\ndef create():\n    raise OSError\n")
    line = file.read_text().splitlines().index("def create():") + 1
    spec = SystemSpec(name=f"{file}:create")
    with pytest.raises(UserError) as refused:
        load_system(spec)
    assert str(refused.value).startswith(f"{file}, line {line}, does not declare that 'create'")
    assert str(refused.value).endswith(f"as in `def create(...) -> {annotation}:`")
    file.write_text(file.read_text().replace("create()", f"create() -> {annotation}"))
    with pytest.raises(OSError, match=r"^$"):
        load_system(spec)


@pytest.mark.parametrize(
    ("name", "option"),
    [
        ("os:system", "command"),
        ("signal:pause", ""),
        *((f"builtins:{name}", "") for name in ("dict", "exit", "object", "type")),
        *((name, "") for name in ("abc:ABC", "math:sqrt", "threading:Thread", "typing:Any")),
    ],
)
def test_what_is_pythons_own_is_never_called(name, option, tmp_path):
    options = {option: f"touch {tmp_path}/ran"} if option else {}
    with pytest.raises(UserError):
        load_system(SystemSpec(name=name, options=options))
    assert not list(tmp_path.iterdir())
