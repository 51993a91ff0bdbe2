"""A system that ends its process, prints or warns: the command ends in its own way all the same."""

import io
import signal
import subprocess
import sys
import warnings
from contextlib import redirect_stderr
from pathlib import Path

import pytest
from cli_runs import TOY, faultpath

ENDINGS = {
    "crash": ("ctypes.string_at(0)", 2, "signal 11, SIGSEGV"),
    "kill": ("os.kill(os.getpid(), 9)", 2, "SIGKILL, often for want of memory"),
    "end": ("os._exit(0)", 2, "with status 0"),
    "end before the thread": ("threading.Thread(target=time.sleep, args=(60,)).start()", 0, ""),
    "end before what waits": ("atexit.register(time.sleep, 60)", 0, ""),
    "status": ("sys.exit(141)", 141, ""),
    "stop": ("os.kill(os.getppid(), 15)\n    time.sleep(60)", -signal.SIGTERM, ""),
    "error": ("1 / 0", 1, "ZeroDivisionError"),
}

WORK = """
import atexit, ctypes, os, sys, threading, time
from faultpath.cli import apart
apart._LAST_S = 0.2
def work():
    print("said")
    sys.stdout.flush()
    {}
    sys.stdout.write("written")
apart.run(work)
"""


@pytest.mark.parametrize(("line", "status", "says"), ENDINGS.values(), ids=ENDINGS)
def test_however_the_work_ends_the_command_ends(line: str, status: int, says: str) -> None:
    asked = [sys.executable, "-c", WORK.format(line)]
    done = subprocess.run(asked, capture_output=True, text=True, timeout=30)
    assert done.returncode == status, done.stderr
    assert done.stdout == ("said\nwritten" if status == 0 else "said\n")
    assert says in done.stderr
    if status == 2:
        (sentence,) = done.stderr.splitlines()
        assert sentence.startswith("faultpath: what the command ran ended the process")
    else:
        assert bool(says) == bool(done.stderr)


@pytest.mark.parametrize(
    ("lines", "says"),
    [("import ctypes\nctypes.string_at(0)", "SIGSEGV"), ("import os\nos._exit(0)", "status 0")],
    ids=["crash", "end"],
)
def test_a_system_that_ends_its_process_is_named(lines: str, says: str, tmp_path: Path) -> None:
    (tmp_path / "mine.py").write_text(f"{lines}\n")
    code = "from faultpath.cli.main import main; main()"
    asked = [sys.executable, "-c", code, "trace", "mine.py:create"]
    done = subprocess.run(asked, capture_output=True, text=True, timeout=60, cwd=tmp_path)
    assert done.returncode == 2
    (sentence,) = done.stderr.splitlines()
    assert sentence.startswith("faultpath: what the command ran ended the process")
    assert says in sentence


NOISY = f"""
import os, sys, warnings
import numpy as np
sys.path.insert(0, {str(Path(TOY).parent)!r})
from toy import create
print("\\x1b[31mred\\nsecond\\u202eline")
print("\\x9bJ", file=sys.stderr)
warnings.warn("of two\\nlines\\x07", stacklevel=1)
np.array([1e308]) * 10
sys.stdout.write("unfinished")
"""


@pytest.mark.filterwarnings("always")
def test_what_a_system_prints_while_it_loads_is_no_output_of_the_command(tmp_path: Path) -> None:
    mine = tmp_path / "mine.py"
    mine.write_text(NOISY)
    ended = faultpath("trace", f"{mine}:create")
    assert ended.status == 0
    assert "[31mred" not in ended.out
    assert "unfinished" not in ended.out


def test_warnings_after_loading_are_lines_too_and_those_of_numpy_none(tmp_path: Path) -> None:
    from faultpath.prints import show_warning

    said = io.StringIO()
    with redirect_stderr(said), warnings.catch_warnings():
        warnings.showwarning = show_warning
        warnings.simplefilter("always")
        warnings.warn_explicit("a\nb", UserWarning, str(tmp_path / "x.py"), 7)
        for text in ("overflow encountered in multiply", "invalid value encountered in scalar add"):
            warnings.warn_explicit(text, RuntimeWarning, "x.py", 7)
    assert said.getvalue() == f"{tmp_path / 'x.py'}, line 7: UserWarning: a b\n"
