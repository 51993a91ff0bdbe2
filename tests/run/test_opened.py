"""Files that a system reads and does not declare: an edit would go unnoticed."""

import os
from pathlib import Path

import numpy as np
import pytest
from written import written

from faultpath.api.audit import audit
from faultpath.core.errors import UserError
from faultpath.run.apart import reads

READ = "np.load(Path(__file__).with_name('gain.npy'))"
ASKED = {
    "baseline": "calibrated",
    "repair": "blind",
    "fault": "gain:scale=0.6",
    "library": "carts",
    "scenes": 1,
    "signals": False,
    "progress": False,
}


pytestmark = pytest.mark.usefixtures("elsewhere", "without_pages")


def old(path: Path) -> Path:
    """Let a file be there since before anything ran."""
    os.utime(path, (0, 0))
    return path


def mine(declared: str = "", built: str = "pass", stepped: str = "pass") -> str:
    np.save("gain.npy", np.ones(3))
    old(Path("gain.npy"))
    run = f"def run(self, *asked):\n    {stepped}\n    return super().run(*asked)"
    return written(Path(), f"{declared}\ndef __init__(self):\n    {built}\n{run}")


@pytest.mark.parametrize(("when", "workers"), [("built", 0), ("stepped", 0), ("stepped", 1)])
def test_a_file_that_is_read_undeclared_is_refused(when, workers, tmp_path) -> None:
    with pytest.raises(UserError, match=r"reads gain\.npy.*`data_files=\('gain\.npy',\)`"):
        audit(mine(**{when: READ}), **ASKED, workers=workers, folder=tmp_path / "run")
    assert not list(tmp_path.glob("run/shards/*"))


def test_one_that_comes_later_is_noticed_though_all_trials_are_kept(tmp_path) -> None:
    system = mine(built=f"Path('more.npy').exists() and {READ}")
    audit(system, **ASKED, workers=0, folder=tmp_path / "run")
    Path("more.npy").touch()
    with pytest.raises(UserError, match=r"reads gain\.npy"):
        audit(system, **ASKED, workers=0, folder=tmp_path / "run")


@pytest.mark.parametrize("declared", ["data_files = ('gain.npy',)", "data_files = ('.',)"])
def test_a_declared_one_is_read_and_an_edit_makes_it_another_run(declared, tmp_path) -> None:
    system = mine(declared, READ, READ)
    first = audit(system, **ASKED, workers=0)
    np.save("gain.npy", np.zeros(3))
    assert audit(system, **ASKED, workers=0).folder != first.folder


def test_what_a_system_wrote_itself_is_no_input(tmp_path) -> None:
    write = "Path('scratch').write_text('1'); Path('scratch').read_text()"
    run = "import subprocess; subprocess.run(['touch', 'other']); Path('other').read_text()"
    audit(mine(stepped=f"{write}; {run}"), **ASKED, workers=0, folder=tmp_path / "run")


def test_a_file_written_at_once_is_no_input(tmp_path) -> None:
    file = old_text(tmp_path / "mine.txt")
    for _ in range(50):  # files are stamped by a clock that lags behind the finer one
        with reads() as opened:
            os.utime(file)
            file.read_text()
        assert opened == set()


def test_only_what_is_the_users_counts_and_only_while_something_watches(tmp_path) -> None:
    file = old_text(tmp_path / "mine.txt")
    with reads() as outer:
        file.read_text()
        with reads() as inner:
            Path(np.__file__).read_bytes()
            (Path(np.__file__).parent / "py.typed").read_bytes()
            Path("/proc/cpuinfo").read_bytes()
            Path(__file__).read_bytes()
            (tmp_path / "made").write_text("x")
            (tmp_path / "made").read_text()
            with pytest.raises(FileNotFoundError):
                (tmp_path / "absent").read_text()
    assert (outer, inner) == ({str(file.resolve())}, set())
    installed = tmp_path / "site" / "tool-1.0.dist-info" / "entry_points.txt"
    installed.parent.mkdir(parents=True)
    with reads() as inner:
        old_text(installed).read_text()
    assert inner == set()
    other = old_text(tmp_path / "other.txt")
    other.read_text()
    assert outer == {str(file.resolve())}


def old_text(path: Path) -> Path:
    path.write_text("1")
    return old(path)
