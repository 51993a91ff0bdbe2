"""From a module to the files behind it."""

import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from faultpath.trials.code import CodeState, read_code
from faultpath.trials.imports import Root

Files = Callable[..., Path]


@pytest.fixture
def files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Files:
    """Write a tree of sources, by path, into a folder that imports are looked for in."""
    monkeypatch.setattr(sys, "path", [*sys.path, str(tmp_path)])

    def write(**sources: str) -> Path:
        for name, text in sources.items():
            path = tmp_path / f"{name.replace('__in__', '/')}.py"
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text)
        return tmp_path

    return write


def _state(root: Path) -> CodeState:
    return read_code([Root("zz_main", root / "zz_start.py")]).state


def _sources(root: Path) -> list[Path]:
    return [*read_code([Root("zz_main", root / "zz_start.py")]).sources.values()]


def test_local_modules_are_followed_and_others_are_not(files):
    root = files(
        zz_start="import json, zz_one\ndef f():\n    from zz_pack import late",
        zz_one="import numpy, zz_absent, zz_start",
        zz_pack__in____init__="",
        zz_pack__in__late="from .beside import x\nfrom . import other",
        zz_pack__in__beside="x = 1",
        zz_pack__in__other="",
        zz_pack__in__unused="",
        zz_unused="",
    )
    found = _state(root)
    pack = {f"zz_pack/{name}.py" for name in ("__init__", "late", "beside", "other")}
    assert set(found.files) == {"zz_start.py", "zz_one.py"} | pack
    assert set(found.packages) == {"numpy"}


def test_folders_without_an_init_file_are_packages_too(files):
    root = files(
        zz_start="from zz_pack.plain import one\nimport zz_bare.deep.two",
        zz_pack__in____init__="",
        zz_pack__in__plain__in__one="import zz_pack.plain.deeper.three",
        zz_pack__in__plain__in__deeper__in__three="",
        zz_bare__in__deep__in__two="",
        zz_bare__in__unused="",
    )
    names = {path.name for path in _sources(root)}
    assert names == {"zz_start.py", "__init__.py", "one.py", "two.py", "three.py"}


def test_with_a_computed_name_all_that_lies_beside_counts(files):
    root = files(
        zz_start="import importlib\nimportlib.import_module(name)",
        zz_plugins__in__one="import zz_deep",
        zz_deep="",
    )
    for folder in (".hidden", "environment"):
        (root / folder).mkdir()
        (root / folder / "not.py").touch()
    (root / "environment" / "pyvenv.cfg").touch()
    assert {path.name for path in _sources(root)} == {"zz_start.py", "one.py", "zz_deep.py"}


def test_a_project_may_move(files, tmp_path):
    root = files(zz_start="import numpy")
    (tmp_path / "elsewhere").mkdir()
    (root / "zz_start.py").rename(tmp_path / "elsewhere" / "zz_start.py")
    moved = _state(tmp_path / "elsewhere")
    files(zz_start="import numpy")
    assert moved == _state(root)


def test_another_release_of_a_package_changes_the_digest(files, monkeypatch):
    root = files(zz_start="import numpy")
    before = _state(root)
    monkeypatch.setattr("faultpath.trials.imports.release", lambda package: "0")
    assert _state(root).changed(before) == ("numpy",)


def test_data_files_count_with_their_contents(files):
    root = files(zz_start="")
    (root / "weights").mkdir()
    (root / "weights" / "a.bin").write_bytes(b"1")
    places = [Path("weights")]

    def state() -> CodeState:
        return read_code([Root("zz_main", root / "zz_start.py")], places, root).state

    before = state()
    assert set(before.data) == {"weights/a.bin"}
    (root / "weights" / "b.bin").write_bytes(b"")
    assert before.changed(state()) == ("weights/b.bin",)


def test_an_installed_system_is_entered_and_what_it_uses_is_not(tmp_path, monkeypatch):
    place = tmp_path / "site-packages"
    for name in ("zz_mine", "zz_theirs"):
        (place / name).mkdir(parents=True)
        (place / name / "__init__.py").write_text("import zz_theirs\n")
        (place / f"{name}-1.5.dist-info").mkdir()
        (place / f"{name}-1.5.dist-info" / "METADATA").write_text(f"Name: {name}\nVersion: 1.5\n")
    monkeypatch.setattr(sys, "path", [*sys.path, str(place)])
    found = read_code([Root("zz_mine")]).state
    assert (set(found.files), found.packages) == ({"zz_mine/__init__.py"}, {"zz_theirs": "1.5"})
    (place / "zz_own.py").touch()  # of no distribution: its contents are all that is known
    (place / "zz_mine" / "__init__.py").write_text("import zz_own\n")
    assert "zz_own.py" in read_code([Root("zz_mine")]).state.files


@pytest.mark.parametrize(
    ("source", "found"),
    [
        ("import zz_a.zz_b as c, zz_d", {"zz_a/zz_b.py", "zz_d.py"}),
        ("x = 1; from zz_a import zz_b as c", {"zz_a/zz_b.py"}),
        ("def f():\n    class A:\n        import zz_d", {"zz_d.py"}),
        ("try:\n    import zz_absent\nexcept ImportError:\n    import zz_d", {"zz_d.py"}),
        ("if x:\n    pass\nelse:\n    import zz_d", {"zz_d.py"}),
        ("match x:\n    case 1:\n        import zz_d", {"zz_d.py"}),
        ("if TYPE_CHECKING:\n    import zz_d\nelse:\n    import zz_a.zz_b", {"zz_a/zz_b.py"}),
        ("f = lambda: __import__('zz_' + x)", {"zz_a/zz_b.py", "zz_d.py"}),
        ('"""import zz_d"""  # import zz_d', set()),
        ("import", set()),
        ("runpy.run_path(place)", {"zz_a/zz_b.py", "zz_d.py"}),
    ],
)
def test_every_import_is_found_wherever_it_stands(source, found, files):
    root = files(zz_start=source, zz_d="", zz_a__in____init__="", zz_a__in__zz_b="")
    seen = {path.relative_to(root.resolve()).as_posix() for path in _sources(root)}
    assert seen - {"zz_start.py", "zz_a/__init__.py"} == found


def test_a_distribution_that_carries_our_name_is_entered_by_whoever_imports_it(
    tmp_path, monkeypatch
):
    """As `faultpath_quadrotor` is: it may be edited where it lies, and counts by content."""
    place = tmp_path / "site-packages" / "faultpath_yy"
    place.mkdir(parents=True)
    (place / "__init__.py").touch()  # a front door decides no result
    (place / "used.py").write_text("__import__('faultpath_yy.' + x)\n")
    (place / "late.py").touch()
    (tmp_path / "zz_start.py").write_text("import faultpath_yy.used\n")
    monkeypatch.setattr(sys, "path", [*sys.path, str(place.parent)])
    found = _state(tmp_path)
    assert set(found.files) == {"zz_start.py", "faultpath_yy/used.py"}
    assert found.packages == {}
