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
    listed = re.findall(r"^\| `(\w+)[`(]", DOCS.read_text(), re.MULTILINE)
    top = [name for name in faultpath.__all__ if name != "__version__"]
    assert listed == [*top, *faultpath.api.__all__]
    assert len(faultpath.__all__) <= 13


@pytest.mark.parametrize(
    ("package", "name"),
    [(package, name) for package in (faultpath, faultpath.api) for name in package.__all__],
)
def test_every_name_is_there_and_says_what_it_is(package, name):
    found = getattr(package, name)
    assert name in dir(package)
    assert name == "__version__" or (found.__doc__ or "").strip()


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
import faultpath, faultpath_quadrotor, torch  # the second says what torch computes with
torch.set_num_threads(3)
before = (torch.get_num_threads(), dict(os.environ), random.getstate(), os.getcwd())
handler = signal.getsignal(signal.SIGINT)
system = faultpath.load_system("quadrotor", options={"wind": "L1", "candidates": 1024})
assert system.interface and "gru" in system.variants
faultpath.audit(
    TOY, baseline="calibrated", repair="blind", fault="gain:scale=0.6", library="carts", scenes=8,
    workers=0, progress=False,
)
assert before == (torch.get_num_threads(), dict(os.environ), random.getstate(), os.getcwd())
assert signal.getsignal(signal.SIGINT) is handler
"""


def test_calls_leave_the_process_as_it_was(tmp_path):
    """The quadrotor's is loaded too."""
    toy = Path(__file__).resolve().parents[2] / "examples" / "toy.py"
    code = f"TOY = {str(toy)!r}\n{LEFT_ALONE}"
    there = {**os.environ, "OMP_NUM_THREADS": "4"}
    line = [sys.executable, "-c", code]
    done = subprocess.run(line, cwd=tmp_path, env=there, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
