"""The example of a learned world model: fitted in its quick form, and audited."""

import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
EXAMPLE = ROOT / "examples" / "learned_pendulum.py"
FIT_AND_AUDIT = """
import runpy
import sys

import faultpath

example = sys.argv[1]
sys.argv = [example, "--windows", "60", "--epochs", "1"]
runpy.run_path(example, run_name="__main__")
run = faultpath.audit(
    example,
    baseline="exact",
    repair="uncertain",
    fault="motor_gain:scale=0.6",
    library="training",
    scenes=2,
    options={"weights": "runs/learned-pendulum"},
    workers=0,
    progress=False,
)
print([path.name for path in run.record.paths])
print(sorted(set(run.table().column("status").to_pylist())))
print([str(finding) for finding in run.record.findings])
print(sorted(name.rpartition("/")[2] for name in run.provenance.data))
shipped = faultpath.load_system(example)
print([len(shipped.modules(name, 0)) for name in shipped.variants])
"""


@pytest.mark.slow
def test_it_runs_from_an_empty_folder_and_its_fits_are_matched_and_audited(tmp_path: Path) -> None:
    """One process for all of it: half of the time goes into loading torch and Gymnasium."""
    pytest.importorskip("torch")
    line = [sys.executable, "-c", FIT_AND_AUDIT, str(EXAMPLE)]
    done = subprocess.run(line, cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    fitted, *_, paths, ends, findings, weights, shipped = done.stdout.splitlines()
    assert fitted.startswith("matched in all but the repair (uncertainty training: motor_gain")
    assert paths == "['correct', 'encoder', 'planner', 'shared']"
    assert "failed" not in ends
    assert findings == "[]"
    kinds = ("json", "safetensors")
    assert weights == str([f"{name}-0.{of}" for name in ("exact", "uncertain") for of in kinds])
    assert shipped == "[2, 2]"
