"""What is public, and what importing it costs."""

import inspect
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

import faultpath

DOCS = Path(__file__).resolve().parents[2] / "docs" / "python.md"


def test_few_names_are_public_and_all_are_listed():
    top = [name for name in faultpath.__all__ if name != "__version__"]
    for package, names in {"faultpath": top, "faultpath.api": faultpath.api.__all__}.items():
        block = rf"<!-- begin:api:{package} -->\n```text\n(.*?)```"
        (listed,) = re.findall(block, DOCS.read_text("utf-8"), re.S)
        assert re.findall(r"^\w+", listed, re.M) == names
    assert len(faultpath.__all__) <= 13


@pytest.mark.parametrize(
    ("package", "name"),
    [(package, name) for package in (faultpath, faultpath.api) for name in package.__all__],
)
def test_every_name_is_there_and_says_what_it_is(package, name):
    thing = getattr(package, name)
    assert name in dir(package)
    assert name == "__version__" or (thing.__doc__ or "").strip()


@pytest.mark.parametrize("function", [faultpath.audit, faultpath.map, faultpath.api.audits])
def test_every_call_shows_its_fields(function):
    shown = inspect.signature(function).parameters
    assert {"system", "baseline", "repair", "fault", "seeds", "progress"} <= set(shown)
    assert all(f"{each}: " in function.__doc__ for each in shown)


def test_a_name_that_there_is_none_of():
    with pytest.raises(AttributeError, match="no attribute 'octopus'"):
        faultpath.octopus  # noqa: B018 - the look itself raises
    with pytest.raises(AttributeError, match=r"'faultpath\.api' has no attribute 'octopus'"):
        faultpath.api.octopus  # noqa: B018 - likewise


def test_importing_loads_nothing_heavy():
    code = (
        "import sys, faultpath\n"
        "heavy = {'numpy', 'scipy', 'torch', 'rich', 'pyarrow', 'pydantic', 'jinja2', 'pandas'}\n"
        "assert not heavy & set(sys.modules), heavy & set(sys.modules)\n"
        "faultpath.audit, faultpath.Run, faultpath.load_system\n"
        "assert 'torch' not in sys.modules\n"
    )
    subprocess.run([sys.executable, "-c", code], check=True, timeout=60)


LEFT_ALONE = """
import os, random, signal, sys
import numpy as np, torch

def state():
    cudnn = torch.backends.cudnn
    return {
        "threads": torch.get_num_threads(),
        "threads between": torch.get_num_interop_threads(),
        "gradients": torch.is_grad_enabled(),
        "precision": (torch.get_default_dtype(), torch.get_float32_matmul_precision()),
        "cudnn": (cudnn.allow_tf32, cudnn.deterministic, cudnn.benchmark),
        "draws": (torch.get_rng_state().tolist(), random.getstate(), repr(np.random.get_state())),
        "rounding": np.geterr(),
        "environment": dict(os.environ),
        "folder": os.getcwd(),
        "signals": [signal.getsignal(each) for each in sorted(signal.valid_signals())],
        "hooks": (list(sys.meta_path), list(sys.path_hooks), sys.excepthook),
    }

torch.set_num_threads(3)
before, path = state(), list(sys.path)
import faultpath, faultpath_quadrotor.plant.module
from faultpath.run.plan import Treatment
from faultpath.run.attempt import Done, attempt
system = faultpath.load_system("quadrotor", options={"wind": "L1", "candidates": 1024})
faultpath_quadrotor.plant.module.CONTROL_STEPS = 8
scene = system.library("selection").scenes[0].id
assert isinstance(attempt(system, Treatment(variant="zero-wind"), [scene]), Done)
faultpath.audit(
    TOY, baseline="calibrated", repair="blind", fault="gain:scale=0.6", library="carts", scenes=2,
    workers=0, progress=False,
)
after = state()
print([name for name in before if before[name] != after[name]])
print([place for place in sys.path if place not in path], sys.path[: len(path)] == path)
"""


def test_calls_leave_the_process_as_it_was(tmp_path):
    """Threads of torch, environment, random states: also when they run the quadrotor."""
    examples = Path(__file__).resolve().parents[2] / "examples"
    code = f"TOY = {str(examples / 'toy.py')!r}\n{LEFT_ALONE}"
    there = {name: value for name, value in os.environ.items() if "NUM_THREADS" not in name}
    line = [sys.executable, "-P", "-c", code]
    done = subprocess.run(line, cwd=tmp_path, env=there, capture_output=True, text=True)
    assert done.stdout.splitlines() == ["[]", f"{[str(examples)]} True"], done.stderr
