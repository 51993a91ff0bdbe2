"""A policy of Stable-Baselines3 and the same one in ONNX: both run as modules, untouched."""

from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

pytest.importorskip("onnxruntime")
pytest.importorskip("stable_baselines3")

from foreign_trials import ROOT, attempted, faulted, loaded

import faultpath

EXAMPLE = ROOT / "examples" / "guarded_policy.py"
FREEZE = "pole:freeze,onset_s=2,for_s=0.3"
RUNTIMES = ("onnx", "sb3")


@pytest.fixture(scope="module")
def example() -> ModuleType:
    return loaded(EXAMPLE)


def audit(system: object, folder: Path, **options: object) -> faultpath.Run:
    question = {"baseline": "plain", "repair": "guarded", "fault": FREEZE}
    running = {"folder": folder, "signals": False, "progress": False}
    return faultpath.audit(system, **question, **running, **options)


def test_both_choose_the_same_for_each_observation(example) -> None:
    rng = np.random.default_rng(0)
    readings = rng.uniform(-0.5, 0.5, (2, 500, 2)).astype(np.float32)
    choices = [
        policy.step({port: readings[i] for i, port in enumerate(sorted(policy.ports))}, None)[0]
        for policy in (example.by_onnx_runtime(), example.by_stable_baselines3())
    ]
    assert np.array_equal(choices[0]["choice"], choices[1]["choice"])
    assert set(choices[0]["choice"]) == {0, 1}


def test_the_guard_helps_only_where_the_policy_alone_is_faulted(example, tmp_path: Path) -> None:
    run = audit(example.create("onnx"), tmp_path / "run", scenes=12, workers=0)
    conditions = {effect.condition: effect for effect in run.record.effects}
    counts = {name: effect.won for name, effect in conditions.items()}
    assert counts == {
        "correct": ((0, 0),),
        "guard": ((0, 0),),
        "policy": ((12, 0),),
        "shared": ((0, 0),),
    }
    assert not run.words.findings
    assert run.headline in (ROOT / "docs" / "torch.md").read_text("utf-8")


@pytest.mark.parametrize("variant", ["plain", "guarded"])
def test_trials_end_alike_with_both(example, variant: str) -> None:
    fault = FREEZE.replace("freeze", "freeze@policy")
    onnx, sb3 = (
        attempted(example.create(runtime), variant, ("seed/3",), fault) for runtime in RUNTIMES
    )
    assert onnx.outcomes == sb3.outcomes


@pytest.mark.parametrize("module", ["policy", "guard"])
def test_a_fault_at_one_reader_reaches_that_reader_alone(example, module: str) -> None:
    fault = FREEZE.replace("freeze", f"freeze@{module}")
    trial = attempted(example.create(), "guarded", ("seed/3",), fault)
    assert faulted(trial) == {f"{module}.pole": 15}


@pytest.mark.parametrize("runtime", RUNTIMES)
def test_the_check_passes_without_a_remark(example, runtime: str) -> None:
    report = faultpath.check(example.create(runtime), scenes=2, workers=0, progress=False)
    assert not report.failures
    assert not [remark for check in report.checks for remark in check.remarks]


@pytest.mark.parametrize("runtime", RUNTIMES)
def test_a_policy_file_that_is_not_declared_is_refused(runtime: str, tmp_path: Path) -> None:
    text = EXAMPLE.read_text("utf-8")
    declared = '        data_files=[ONNX if runtime == "onnx" else WEIGHTS],\n'
    assert declared in text
    (place := tmp_path / EXAMPLE.name).write_text(text.replace(declared, ""), "utf-8")
    (tmp_path / EXAMPLE.stem).symlink_to(EXAMPLE.with_suffix(""))
    chosen = {"scenes": 2, "workers": 0, "options": {"runtime": runtime}}
    with pytest.raises(faultpath.UserError, match="data_files"):
        audit(f"{place}:create", tmp_path / "run", **chosen)


@pytest.mark.filterwarnings("ignore")  # the exporter's, about its age
def test_training_writes_both_files_of_one_network(tmp_path: Path) -> None:
    (place := tmp_path / "guarded_policy.py").write_text(EXAMPLE.read_text("utf-8"), "utf-8")
    (module := loaded(place)).train(256)
    files = {path.name: path.stat().st_size for path in module.FILES.iterdir()}
    assert set(files) == {"policy.onnx", "policy.safetensors"}
    assert max(files.values()) < 50_000
    test_both_choose_the_same_for_each_observation(module)
