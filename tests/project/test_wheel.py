"""The wheel, where there is nothing but the dependencies of the engine: no torch, no extra."""

import os
import re
import shutil
import subprocess
import sys
import zipfile
from importlib.metadata import distribution
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from packaging.requirements import Requirement

ROOT = Path(__file__).resolve().parents[2]
BUILT_FROM = ("pyproject.toml", "README.md", "LICENSE", "src", "examples")
PIP = (sys.executable, "-m", "pip", "--disable-pip-version-check", "-q")
VERSIONS = ("--baseline", "calibrated", "--repair", "blind", "--fault", "gain:scale=0.6")


def called(*command: str | Path, **environment: str) -> str:
    done = subprocess.run(
        command, capture_output=True, text=True, env={**os.environ, **environment}
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A wheel as `pip` makes it, from a copy: the kernels in use are left alone."""
    source = tmp_path_factory.mktemp("source")
    for name in BUILT_FROM:
        place = ROOT / name
        if place.is_dir():
            ignored = shutil.ignore_patterns("kernels-*", "__pycache__")
            shutil.copytree(place, source / name, ignore=ignored)
        else:
            shutil.copy(place, source / name)
    out = tmp_path_factory.mktemp("wheel")
    options = ("--no-deps", "--no-build-isolation", "--no-index", "-w", out)
    called(*PIP, "wheel", *options, source, PYTHONPATH="", HATCH_BUILD_HOOK_ENABLE_CUSTOM="")
    (built,) = out.iterdir()
    return built


def test_with_the_hook_and_without_a_compiler_the_wheel_is_pure_too(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.syspath_prepend(str(ROOT / "quadrotor"))
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.delenv("CXX", raising=False)
    from hatch_build import KernelHook

    warnings: list[str] = []
    about: dict[str, Any] = {"artifacts": []}
    app = SimpleNamespace(display_warning=warnings.append)
    KernelHook(str(tmp_path), {}, None, None, "", "wheel", app=app).initialize("", about)
    assert about == {"artifacts": []}
    assert warnings == ["No C++ compiler: the portable path will run instead."]


def needed(name: str, known: set[str] | None = None) -> set[str]:
    """Return a package and all that it needs without extras, by name."""
    known = set() if known is None else known
    if name not in known:
        known.add(name)
        for line in distribution(name).requires or ():
            requirement = Requirement(line)
            if requirement.marker is None or requirement.marker.evaluate({"extra": ""}):
                needed(requirement.name, known)
    return known


def environment(folder: Path) -> Path:
    """Return the Python of a new environment that holds the engine's dependencies and no more."""
    called(sys.executable, "-m", "venv", "--without-pip", folder)
    (packages,) = folder.glob("lib/python*/site-packages")
    for name in needed("faultpath") - {"faultpath"}:
        files = distribution(name).files or ()
        for top in {file.parts[0] for file in files} - {"..", "__pycache__"}:
            (packages / top).symlink_to(distribution(name).locate_file(top))
    return folder / "bin" / "python"


@pytest.mark.slow
def test_the_engine_is_installed_and_audits_without_compiler_or_extra(
    wheel: Path, tmp_path: Path
) -> None:
    assert wheel.name.endswith("-py3-none-any.whl")
    with zipfile.ZipFile(wheel) as files:
        names = files.namelist()
        (about,) = (files.read(name).decode() for name in names if name.endswith("/METADATA"))
    assert "License-Expression: Apache-2.0\nLicense-File: LICENSE\n" in about
    assert any(name.endswith("licenses/LICENSE") for name in names)
    assert not any(name.endswith(".so") for name in names)
    assert "faultpath/schemas/record.schema.json" in names

    python = environment(tmp_path / "environment")
    outside = {"PYTHONPATH": "", "NO_COLOR": "1", "COLUMNS": "200"}
    options = ("--no-index", "--no-deps", "--no-compile")
    called(*PIP, "--python", python, "install", *options, wheel, PYTHONPATH="")
    called(*PIP, "--python", python, "check", PYTHONPATH="")
    command = python.parent / "faultpath"
    assert called(command, "--version", **outside) == f"faultpath {wheel.name.split('-')[1]}\n"

    toy = f"{ROOT / 'examples' / 'toy.py'}:create"
    run = tmp_path / "run"
    scenes = ("--library", "carts", "--scenes", "10", "--workers", "1", "--out", run)
    assert "Correct inputs" in called(command, "audit", toy, *VERSIONS, *scenes, **outside)
    assert (run / "report.html").is_file()
    shown = called(command, "demo", "--out", tmp_path / "demo", **outside)
    assert "Do not choose by the fault at the observer alone" in shown
    assert (tmp_path / "demo" / "report.html").is_file()

    page = (ROOT / "docs" / "faq.md").read_text("utf-8")
    block = re.search(r"```console refused-by-the-engine\n\$ (.*)\n(.*)\n```", page)
    assert block is not None
    line = [command, *block[1].split()[1:]]
    done = subprocess.run(line, capture_output=True, text=True, env={**os.environ, **outside})
    assert (done.returncode, done.stderr.strip()) == (2, block[2])
