"""The example of a learned world model: fitted in its quick form, and audited."""

import subprocess
import sys
from pathlib import Path

import pytest

EXAMPLE = Path(__file__).resolve().parents[2] / "examples" / "learned_pendulum.py"
AUDIT = """
import sys
import faultpath

run = faultpath.audit(
    sys.argv[1] + ":create",
    baseline="exact",
    repair="uncertain",
    fault="motor_gain:scale=0.8",
    library="training",
    scenes=2,
    workers=0,
    progress=False,
)
print([path.name for path in run.record.paths])
print(sorted(set(run.table().column("status").to_pylist())))
print([str(finding) for finding in run.record.findings])
"""


@pytest.mark.slow
def test_it_is_fitted_matched_and_audited(tmp_path: Path) -> None:
    def said(*arguments: str) -> list[str]:
        done = subprocess.run(
            [sys.executable, *arguments], cwd=tmp_path, capture_output=True, text=True
        )
        assert done.returncode == 0, done.stderr
        return done.stdout.splitlines()

    fitted = said(str(EXAMPLE), "--windows", "60", "--epochs", "1")
    assert fitted[0].startswith("matched in all but the repair (uncertainty training: motor_gain")
    paths, ends, findings = said("-c", AUDIT, str(EXAMPLE))
    assert paths == "['correct', 'encoder', 'planner', 'shared']"
    assert "failed" not in ends
    assert findings == "[]"
