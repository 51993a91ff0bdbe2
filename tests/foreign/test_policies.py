"""A policy of Stable-Baselines3 and the same one in ONNX: both run as modules, untouched."""

import importlib.util
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

pytest.importorskip("onnxruntime")
pytest.importorskip("stable_baselines3")

import faultpath
from faultpath.faults import parse_fault
from faultpath.trials import Arm
from faultpath.trials.attempt import attempt

ROOT = Path(__file__).resolve().parents[2]
EXAMPLE = ROOT / "examples" / "guarded_policy.py"
FREEZE = "pole:freeze,onset_s=2,for_s=0.3"
RUNTIMES = ("onnx", "sb3")


def loaded(path: Path) -> ModuleType:
    spec = importlib.util.spec_from_file_location("guarded_policy", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


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
    paths = {effect.path: effect for effect in run.record.effects}
    counts = {name: (effect.wins, effect.losses) for name, effect in paths.items()}
    assert counts == {
        "correct": ((0,), (0,)),
        "guard": ((0,), (0,)),
        "policy": ((12,), (0,)),
        "shared": ((0,), (0,)),
    }
    assert not run.record.findings
    assert run.record.headline in (ROOT / "docs" / "policies.md").read_text("utf-8")


@pytest.mark.parametrize("variant", ["plain", "guarded"])
def test_trials_end_alike_with_both(example, variant: str) -> None:
    ends = []
    for runtime in RUNTIMES:
        system = example.create(runtime)
        text = FREEZE.replace("freeze", "freeze@policy")
        fault = parse_fault(text, system.interface, {}, system.control_dt_s)
        arm = Arm(variant=variant, faults=fault.resolved(system.interface))
        ends.append(attempt(system, arm, ("seed/3",)).outcomes)
    assert ends[0] == ends[1]


@pytest.mark.parametrize("module", ["policy", "guard"])
def test_a_fault_at_one_reader_reaches_that_reader_alone(example, module: str) -> None:
    system = example.create()
    text = FREEZE.replace("freeze", f"freeze@{module}")
    faults = parse_fault(text, system.interface, {}, system.control_dt_s).resolved(system.interface)
    done = attempt(system, Arm(variant="guarded", faults=faults), ("seed/3",))
    faulted = {tap.consumer: tap.faulted_steps for tap in done.taps if tap.faulted_steps}
    assert faulted == {f"{module}.pole": 15}


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
