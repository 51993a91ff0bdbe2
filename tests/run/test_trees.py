"""The code of a trial counts as all that runs in one, as whole trees of sources."""

import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from faultpath.core import trees
from faultpath.core.errors import UserError
from faultpath.core.trees import Root
from faultpath.faults import at_readers
from faultpath.run.attempt import Done, attempt
from faultpath.run.code import CodeState, read_code, source_state, system_code
from faultpath.run.plan import SystemSpec, Treatment
from faultpath.run.registry import load_system

Files = Callable[..., Path]


@pytest.fixture
def files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Files:
    """Write sources, by path, below a folder `project`, and return that."""
    monkeypatch.setattr(sys, "path", [*sys.path, str(tmp_path / "project")])

    def write(*names: str, **sources: str) -> Path:
        for name, text in {**dict.fromkeys(names, ""), **sources}.items():
            path = tmp_path / "project" / (name if "." in name else f"{name}.py")
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text)
        return tmp_path / "project"

    return write


def _state(folder: Path) -> CodeState:
    return read_code([Root("zz_main", folder / "zz_start.py")]).state


def _own(folder: Path) -> set[str]:
    return {*_state(folder).files} - {"faultpath"}


def test_the_folder_of_a_file_counts_whole_and_what_is_no_source_does_not(files):
    counted = {"zz_start.py", "unused.py", "deep/er/one.py", "fast.so"}
    others = ("notes.txt", ".hidden/a.py", "__pycache__/a.py", "node_modules/a.py")
    folders = ("environment/a.py", "environment/pyvenv.cfg", "run/a.py", "run/manifest.json")
    folder = files(*counted, *others, *folders)
    assert _own(folder) == counted
    before = _state(folder)
    (folder / "deep/er/one.py").write_text("# a word")
    (folder / "notes.txt").write_text("a word")
    assert before.changed(_state(folder)) == ("deep/er/one.py",)


@pytest.mark.parametrize("why", ["home", "temporary", "large"])
def test_of_a_folder_that_is_no_project_only_the_files_beside_count(why, files, monkeypatch):
    folder = files("beside.py", "below/unused.py", "zz_used/one.py", zz_start="import zz_used")
    match why:
        case "home":
            monkeypatch.setattr(Path, "home", lambda: folder)
        case "temporary":
            monkeypatch.setattr(trees, "gettempdir", lambda: str(folder))
        case _:
            monkeypatch.setattr(trees, "_MOST", 4)
    assert _own(folder) == {"zz_start.py", "beside.py", "zz_used"}


@pytest.mark.parametrize(
    "source",
    [
        "import zz_there.one as c, json",
        "import json, zz_there",
        "x = 1; from zz_there.one import x",
        "def f():\n    class A:\n        import zz_there",
        "try: import zz_there\nexcept ImportError: pass",
        "import zz_plain",
    ],
)
def test_code_of_the_users_that_lies_elsewhere_counts_wherever_its_import_stands(
    source, files, tmp_path, monkeypatch
):
    folder = files(zz_start=source)
    place = tmp_path / "elsewhere"
    (place / "zz_there").mkdir(parents=True)
    (place / "zz_there" / "one.py").touch()
    monkeypatch.setattr(sys, "path", [*sys.path, str(place)])
    before = _state(folder)
    (place / "zz_plain.py").touch()
    (place / "zz_there" / "late.py").touch()
    assert before.changed(_state(folder)) == (
        ("zz_plain.py", "zz_there/late.py", "zz_there/one.py")
        if "plain" in source
        else ("zz_there",)
    )


def test_a_project_may_move(files, tmp_path):
    folder = files("deep/one.py", zz_start="import numpy")
    before = _state(folder)
    assert before == _state(folder.rename(tmp_path / "elsewhere"))


def test_sources_of_one_name_in_three_folders_all_count(tmp_path):
    files = [tmp_path / place / "parts" / "zz_part.py" for place in "abc"]
    for file in files:
        file.parent.mkdir(parents=True)
        file.touch()
    roots = [Root(f"zz_part_{place}", file) for place, file in enumerate(files)]
    before = read_code(roots).state
    for file in files:
        file.write_text("pass")
        assert len(read_code(roots).state.changed(before)) == 1
        file.write_text("")


def test_all_parts_of_a_package_in_several_folders_count(files, tmp_path, monkeypatch):
    folder = files(zz_start="import zz_spread")
    parts = [tmp_path / place / "zz_spread" / "one.py" for place in "ab"]
    for part in parts:
        part.parent.mkdir(parents=True)
        part.touch()
    monkeypatch.setattr(sys, "path", [*sys.path, *(str(part.parents[1]) for part in parts)])
    before = _state(folder)
    for part in parts:
        part.write_text("pass")
        assert len(_state(folder).changed(before)) == 1
        part.write_text("")


@pytest.mark.parametrize("name", ["numpy", "packaging"])
def test_another_release_of_a_package_or_of_what_it_requires_changes_the_digest(
    name, files, monkeypatch
):
    folder = files(zz_start="import gymnasium, pytest")
    before = _state(folder)
    release = trees.release
    monkeypatch.setattr(trees, "release", lambda other: "0" if other == name else release(other))
    assert _state(folder).changed(before) == (name,)
    assert _state(folder).digest != before.digest


def test_data_files_count_with_their_contents(files):
    folder = files("zz_start.py", "weights/a.bin")

    def state() -> CodeState:
        root = Root("zz_main", folder / "zz_start.py")
        return read_code([root], [Path("weights")], folder).state

    before = state()
    assert set(before.data) == {"weights/a.bin"}
    (folder / "weights" / "b.bin").touch()
    assert before.changed(state()) == ("weights/b.bin",)
    (folder / "weights" / "c.bin").symlink_to("nowhere")
    with pytest.raises(UserError, match=r"cannot read .*weights/c\.bin \(No such file"):
        state()


def test_an_installed_system_counts_by_its_contents_and_what_it_uses_by_its_version(
    tmp_path, monkeypatch
):
    place = tmp_path / "site-packages"
    for name in ("zz_mine", "zz_theirs"):
        (place / name).mkdir(parents=True)
        (place / name / "__init__.py").write_text("import zz_theirs, faultpath_yy\n")
        (place / f"{name}-1.5.dist-info").mkdir()
    (place / "faultpath_yy").mkdir()  # may be edited where it lies, as `faultpath_quadrotor`
    (place / "faultpath_yy" / "__init__.py").touch()
    monkeypatch.setattr(sys, "path", [*sys.path, str(place)])
    for name in (
        "_installed",
        "_distribution",
        "release",
    ):  # what is remembered for a whole process
        monkeypatch.setattr(trees, name, getattr(trees, name).__wrapped__)
    code = read_code([Root("zz_mine.system")])
    assert set(code.state.files) == {"zz_mine", "faultpath_yy", "faultpath"}
    assert code.state.packages.items() >= {("zz_theirs", "1.5")}
    assert "zz_mine" not in code.state.packages


def test_a_loaded_module_counts_as_it_was_loaded(files):
    folder = files(zz_start="import zz_helper_of_trees", zz_helper_of_trees="X = 1")
    try:
        __import__("zz_helper_of_trees")
        before = _state(folder)
        files(zz_helper_of_trees="X = 2")
        assert _state(folder) == before
    finally:
        sys.modules.pop("zz_helper_of_trees", None)
    assert before.changed(_state(folder)) == ("zz_helper_of_trees.py",)


ROOT = Path(__file__).resolve().parents[2]
FLOWN = {
    "toy": (f"{ROOT}/examples/toy.py:create", {}, "carts", "calibrated", "gain:scale=0.6"),
    "dock": (f"{ROOT}/examples/dock.py:create", {}, "floors", "ranges", "range:scale=0.7"),
    "quadrotor": ("quadrotor", {"wind": "L3"}, "selection", "gru", "calibration=+0.1"),
    "quadrotor on the portable path": (
        "quadrotor",
        {"wind": "L1", "environment": "free-space"},
        "selection",
        "wm-u",
        "calibration=+0.1",
    ),
}


@pytest.mark.parametrize(
    "name",
    [pytest.param(name, marks=pytest.mark.slow if "quadrotor" in name else ()) for name in FLOWN],
)
def test_whatever_runs_in_a_flight_counts(name, monkeypatch):
    if "quadrotor" in name:  # all that runs in a flight runs in a short one
        monkeypatch.setattr("faultpath_quadrotor.plant.module.CONTROL_STEPS", 8)
    if "portable" in name:
        monkeypatch.setenv("FAULTPATH_KERNELS", "portable")
    place, options, library, variant, text = FLOWN[name]
    spec = SystemSpec(name=place, options=options)
    system = load_system(spec)
    scenes = [scene.id for scene in system.library(library).scenes[:1]]
    faults = at_readers(system.fault(text), system.variants[variant].readers)
    code = system_code(system, spec)

    ran: set[str] = set()
    sys.setprofile(lambda frame, event, _: ran.add(frame.f_code.co_filename))
    try:
        done = attempt(system, Treatment(variant=variant, faults=faults), scenes)
    finally:
        sys.setprofile(None)
    assert isinstance(done, Done), done
    ours = {
        Path(file).resolve()
        for file in ran
        if Path(file).is_relative_to(ROOT) and "src" in Path(file).parts
    }
    assert len(ours) > 5
    assert ours <= {path.resolve() for path in code.sources}


@pytest.mark.parametrize("name", ["toy", "quadrotor"])
def test_the_code_is_known_before_loading(name):
    place, options, *_ = FLOWN[name]
    spec = SystemSpec(name=place, options=options)
    assert source_state(spec).files == system_code(load_system(spec), spec).state.files
