"""Examples of learned world models: fitted in their quick form in an empty folder, and audited."""

import subprocess
import sys
from pathlib import Path

import pytest

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"
FIT_AND_AUDIT = """
import runpy
import sys
from pathlib import Path

import faultpath

_, example, arguments, baseline, repair, fault, weights = sys.argv
sys.path.insert(0, str(Path(example).parent))
sys.argv = [example, *arguments.split()]
runpy.run_path(example, run_name="__main__")
run = faultpath.audit(
    example,
    baseline=baseline,
    repair=repair,
    fault=fault,
    library="training",
    scenes=2,
    options={"weights": weights},
    workers=0,
    progress=False,
)
print([condition.name for condition in run.record.conditions])
print("failed" in run.table().column("status").to_pylist() or bool(run.words.findings))
print(sorted(name.rpartition("/")[2] for name in run.provenance.code.data))
shipped = faultpath.load_system(example)
print({len(shipped.modules(name, 0)) for name in shipped.variants})
"""
RUNS = {
    "learned_pendulum.py": (
        "--windows 60 --epochs 1",
        ("exact", "uncertain", "motor_gain:scale=0.6", "runs/learned-pendulum"),
        ["encoder", "planner"],
        2,
    ),
    "latent_camera.py": (
        "--windows 150 --epochs 1 --names plain,augmented",
        ("plain", "augmented", "exposure:scale=0.85", "runs/latent-camera"),
        ["goal", "observation"],
        3,
    ),
}


@pytest.mark.slow
@pytest.mark.parametrize("example", RUNS)
def test_its_fits_are_matched_and_audited(example: str, tmp_path: Path) -> None:
    """One process for all of it: half of the time goes into loading torch and Gymnasium."""
    pytest.importorskip("torch")
    arguments, (*audited, weights), conditions, modules = RUNS[example]
    code = [sys.executable, "-c", FIT_AND_AUDIT, str(EXAMPLES / example), arguments]
    done = subprocess.run([*code, *audited, weights], cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    fitted, *_, flown, wrong, data, shipped = done.stdout.splitlines()
    assert "matched in all but the repair (uncertainty training: " in fitted
    assert "not matched" not in fitted
    assert flown == str(["correct", *conditions, "shared"])
    assert wrong == "False"
    assert data == str(sorted(path.name for path in (tmp_path / weights).iterdir()))
    assert len(data.split(",")) == 4
    assert shipped == str({modules})
