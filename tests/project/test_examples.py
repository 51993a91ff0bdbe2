"""Every example runs from an empty directory."""

from collections.abc import Callable
from pathlib import Path
from subprocess import CompletedProcess

import pytest

QUICK = {"own_model.py": ("--episodes", "40", "--epochs", "1")}
"""Arguments of examples that would take their time without."""
ROOT = Path(__file__).resolve().parents[2]
ELSEWHERE = {
    "basilisk_attitude.py": "tests/foreign/test_basilisk.py",
    "do_mpc_masses.py": "tests/foreign/test_do_mpc.py",
    "guarded_policy.py": "tests/foreign/test_policies.py",
    "latent_camera.py": "tests/learning/test_latent_camera.py",
    "latent_camera_pictures.py": "tests/learning/test_latent_camera.py",
    "learned_pendulum.py": "tests/learning/test_learned_pendulum.py",
    "lerobot_relative_actions.py": "tests/foreign/test_lerobot.py",
    "lerobot_steps.py": "tests/foreign/test_lerobot.py",
    "motulator_drive.py": "tests/foreign/test_motulator.py",
    "openpilot_car.py": "tests/foreign/test_openpilot.py",
    "openpilot_speed.py": "tests/foreign/test_openpilot.py",
    "rotorpy_wind.py": "tests/foreign/test_rotorpy.py",
    "stable_worldmodel_camera.py": "tests/foreign/test_stable_worldmodel.py",
    "stable_worldmodel_model.py": "tests/foreign/test_stable_worldmodel.py",
    "stable_worldmodel_fit.py": "tests/foreign/test_stable_worldmodel.py",
    "wpilib_wheels.py": "tests/foreign/test_wpilib.py",
}
"""Examples that a test of their own runs."""
EXAMPLES = sorted({*(ROOT / "examples").glob("*.py")} - {ROOT / "examples" / e for e in ELSEWHERE})


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda path: path.name)
def test_example_runs(example: Path, run: Callable[..., CompletedProcess[str]]) -> None:
    done = run(str(example), *QUICK.get(example.name, ()))
    assert done.returncode == 0, done.stderr


def test_what_is_run_elsewhere_is_run_there() -> None:
    for example, test in ELSEWHERE.items():
        assert (ROOT / "examples" / example).is_file()
        assert f'"{example}"' in (ROOT / test).read_text("utf-8")
