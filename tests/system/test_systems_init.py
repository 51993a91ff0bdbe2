"""A system that `faultpath init` writes runs, and its own test passes."""

import os
import shlex
import subprocess
import sys
from importlib.resources import files
from importlib.util import find_spec

import pytest

import faultpath
from faultpath.cli.systems import init
from faultpath.core.errors import UserError
from faultpath.system.init import TEMPLATES, write_system


@pytest.mark.slow
def test_new_systems_pass_their_own_tests(tmp_path):
    """All of them in one process: most of the time goes into loading what they need."""
    kinds = [kind for kind in TEMPLATES if kind != "torch" or find_spec("torch")]
    for kind in kinds:
        for written in write_system(f"my_{kind}", kind, tmp_path):
            assert "NAME" not in written.read_text()
    line = [sys.executable, "-m", "pytest", "-q", "-W", "error", "-p", "no:cacheprovider"]
    done = subprocess.run(
        line, cwd=tmp_path, env=os.environ | {"PYTEST_ADDOPTS": ""}, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stdout
    assert f"{3 * len(kinds)} passed" in done.stdout


@pytest.mark.usefixtures("without_pages")
@pytest.mark.parametrize("kind", TEMPLATES)
def test_the_audit_that_a_template_suggests_shows_a_reversal(kind, tmp_path, monkeypatch, capsys):
    """Once every cell of it said 100 %."""
    if kind == "torch":
        pytest.importorskip("torch")
    monkeypatch.chdir(tmp_path)
    init(f"my_{kind}", kind)
    line = next(each for each in capsys.readouterr().out.splitlines() if "audit" in each)
    name, *words = shlex.split(line.replace("--", ""))[2:]
    options = dict(zip(words[::2], words[1::2], strict=True))
    run = faultpath.audit(name, **options, scenes=16, workers=0, signals=False, progress=False)
    decided = {each.condition: each.sign for each in run.record.effects}
    assert decided["observer"] > 0 > decided["shared"]


@pytest.mark.usefixtures("without_pages")
def test_a_single_library_is_taken_and_named_where_none_is_asked_for(tmp_path, monkeypatch, caplog):
    monkeypatch.chdir(tmp_path)
    file, _ = write_system("my_rover", "numpy", tmp_path)
    code = file.read_text().replace("variants, units)", 'variants, units, scenes={"few": [1, 2]})')
    file.write_text(code)
    system, how = f"{file}:create", {"workers": 0, "progress": False}
    assert faultpath.check(system, scenes=1, **how).library == "few"
    versions = {"baseline": "calibrated", "repair": "typical", "fault": "gain:scale=0.6"}
    run = faultpath.audit(system, **versions, signals=False, **how)
    assert run.record.facts.library == "few"
    assert "-few-" in run.folder.name
    assert "Scenes of 'few', the only library of this system." in caplog.messages


def test_an_audit_of_an_environment_takes_forty_lines():
    pytest.importorskip("ruff")
    text = (files("faultpath.system") / "templates" / "gymnasium.py.txt").read_bytes()
    ruff = [sys.executable, "-m", "ruff", "format", "--isolated", "--line-length", "88", "-"]
    formatted = subprocess.run(ruff, input=text, capture_output=True, check=True).stdout
    assert formatted == text
    assert text.count(b"\n") <= 40


def test_what_cannot_be_written_is_said(tmp_path):
    pytest.importorskip("torch")  # one of the names that are taken
    for name in ("my rover", "Rover", "test_rover", "rover_test", "__init__", "_a", "1st", "é", ""):
        with pytest.raises(UserError, match="cannot name a system"):
            write_system(name, "numpy", tmp_path)
    for name in ("numpy", "torch", "gymnasium", "json", "class", "conftest", "usercustomize"):
        with pytest.raises(UserError, match=rf"^'{name}' is an?\b.*: choose .* my_{name}\.$"):
            write_system(name, "numpy", tmp_path)
    with pytest.raises(UserError, match="no template 'jax'"):
        write_system("rover", "jax", tmp_path)
    write_system("rover", "numpy", tmp_path)
    (tmp_path / "rover.py").write_text("mine")
    with pytest.raises(UserError, match=r"rover\.py is there already"):
        write_system("rover", "torch", tmp_path)
    assert (tmp_path / "rover.py").read_text() == "mine"


def test_a_full_disk_leaves_nothing_behind(tmp_path):
    code = (
        "import resource; resource.setrlimit(resource.RLIMIT_FSIZE, (500, 500))\n"
        "from faultpath.cli.main import main; main()"
    )
    line = [sys.executable, "-c", code, "init", "rover"]
    done = subprocess.run(line, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert "rover.py" in done.stderr
    assert not list(tmp_path.iterdir())
