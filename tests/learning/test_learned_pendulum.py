"""Examples of learned world models: fitted in their quick form in an empty folder, and audited."""

import runpy
import sys
from pathlib import Path
from typing import Any

import pytest

import faultpath

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"
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
@pytest.mark.usefixtures("without_pages")
@pytest.mark.parametrize("example", RUNS)
def test_its_fits_are_matched_and_audited(
    example: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """In one scene: the trials of two beside each other are repeated from the stored runs."""
    pytest.importorskip("torch")
    arguments, (baseline, repair, fault, weights), conditions, modules = RUNS[example]
    file = str(EXAMPLES / example)
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(EXAMPLES)  # as Python does for a file that it runs
    monkeypatch.setattr(sys, "argv", [file, *arguments.split()])
    runpy.run_path(file, run_name="__main__")
    fitted = capsys.readouterr().out
    assert "matched in all but the repair (uncertainty training: " in fitted
    assert "not matched" not in fitted
    run = faultpath.audit(
        file,
        baseline=baseline,
        repair=repair,
        fault=fault,
        library="training",
        scenes=1,
        options={"weights": weights},
        workers=0,
        signals=False,
        progress=False,
    )
    assert [condition.name for condition in run.record.conditions] == [
        *("correct", *conditions, "shared")
    ]
    assert (run.failed, run.words.findings) == (0, ())
    data = {name.rpartition("/")[2] for name in run.provenance.code.data}
    assert data == {path.name for path in Path(weights).iterdir()}
    assert len(data) == 4
    shipped: Any = faultpath.load_system(file)
    assert {len(shipped.modules(name, 0)) for name in shipped.variants} == {modules}
