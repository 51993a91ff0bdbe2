"""The template of a package: what it declares is found once it is installed, and only then."""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PIP = (sys.executable, "-m", "pip", "--disable-pip-version-check", "-q")
OFFLINE = ("--no-index", "--no-deps")
QUICK = ("--scenes", "2", "--workers", "0", "--no-signals")
TANK = ("audit", "tank", "--baseline", "slow", "--repair", "quick", *QUICK)
TOY = ("audit", str(ROOT / "examples" / "toy.py"), "--baseline", "calibrated", "--repair", "blind")


@pytest.fixture(scope="module")
def installed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder into which the package is installed as a wheel of it is built."""
    folder = tmp_path_factory.mktemp("package")
    shutil.copytree(ROOT / "examples" / "package", folder / "source")
    source, wheels = str(folder / "source"), folder / "wheels"
    build = (*PIP, "wheel", *OFFLINE, "--no-build-isolation", "-w", wheels, source)
    subprocess.run(build, check=True)
    (wheel,) = wheels.iterdir()
    subprocess.run((*PIP, "install", *OFFLINE, "--target", folder / "site", wheel), check=True)
    return folder


def run(
    folder: Path, *command: str, packages: Path | None = None
) -> subprocess.CompletedProcess[str]:
    places = [os.environ.get("PYTHONPATH", ""), *([str(packages)] if packages else [])]
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(places), "COLUMNS": "300"}
    return subprocess.run(
        (sys.executable, "-m", *command),
        cwd=folder,
        env=environment,
        capture_output=True,
        text=True,
    )


@pytest.mark.slow
def test_an_installed_package_brings_a_system_and_a_kind_of_fault(installed: Path) -> None:
    site = installed / "site"
    options = ("-q", "-c", os.devnull, "-p", "no:cacheprovider")
    own = run(installed / "source", "pytest", *options, "test_tank.py", packages=site)
    assert own.returncode == 0, own.stdout + own.stderr

    # Another's system takes the kind too, and a run resumes only under the same code of it.
    fault = ("--library", "carts", *QUICK, "--fault", "gain:saturate=1", "--out", "run")
    assert run(installed, "faultpath", *TOY, *fault, packages=site).returncode == 0
    manifest = installed / "run" / "manifest.json"
    assert {"toy.py", "tank"} <= set(json.loads(manifest.read_text("utf-8"))["code"]["files"])
    without = run(installed, "faultpath", "report", "run")
    assert without.returncode == 2
    assert "'kind': 'saturate'" in without.stderr
    assert "Traceback" not in without.stderr


@pytest.mark.slow
@pytest.mark.parametrize(
    ("value", "words"),
    [
        ("tank.absent:Saturate", "which cannot be imported (No module named 'tank.absent')"),
        ("tank.system:TARGET_M", "which is no Intervention of it: derive it from"),
    ],
)
def test_a_kind_that_is_declared_wrongly_is_one_sentence(
    installed: Path, tmp_path: Path, value: str, words: str
) -> None:
    site = tmp_path / "site"
    shutil.copytree(installed / "site", site)
    (points,) = site.glob("*.dist-info/entry_points.txt")
    points.write_text(points.read_text("utf-8").replace("tank.faults:Saturate", value), "utf-8")
    done = run(tmp_path, "faultpath", *TANK, "--fault", "level:saturate=1.4", packages=site)
    assert done.returncode == 2
    assert f"the kind of fault 'saturate' is declared as {value}, {words}" in done.stderr
    assert "Traceback" not in done.stderr
