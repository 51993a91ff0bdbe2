"""What every executor does, and what only processes can."""

import os
import re
import signal
import subprocess
import sys
from functools import partial
from pathlib import Path

import calls
import pytest
from calls import alive, end_of
from cli_runs import until

from faultpath.core.errors import UserError
from faultpath.run.work.executor import Failed, Lost, Returned, run_all
from faultpath.run.work.processes import Processes, local

BOTH = pytest.mark.parametrize("workers", [0, 1])


@pytest.mark.parametrize("workers", [0, 2])
def test_every_call_comes_back_with_its_place(workers):
    with local(workers) as executor:
        found = dict(run_all(executor, [partial(calls.double, n) for n in range(20)]))
        assert found == {n: 2 * n for n in range(20)}
        assert dict(run_all(executor, [])) == {}
        assert len(executor.free()) == max(workers, 1)


@BOTH
def test_what_a_call_tells_is_heard_before_its_end(workers):
    heard = []
    with local(workers) as executor:
        assert end_of(executor, partial(calls.count, 3), heard.append) == Returned(3)
        assert heard == [0, 1, 2]
    calls.send_message("nobody")


@BOTH
def test_an_error_is_an_end_with_its_traceback_and_the_next_call_runs(workers):
    with local(workers) as executor:
        end = end_of(executor, partial(calls.leave, "raise"))
        assert isinstance(end, Failed)
        assert repr(end.error) == "ValueError('no air')"
        if workers:
            assert 'raise ValueError("no air")' in end.error.__notes__[0]
        left = end_of(executor, partial(calls.leave, "exit"))
        assert isinstance(left, Failed)
        assert str(left.error) == "it called sys.exit(3)"
        assert end_of(executor, partial(calls.double, 1)) == Returned(2)


@pytest.mark.parametrize(
    ("how", "says"),
    [
        ("kill", "SIGKILL.*memory"),
        ("nameless", f"by signal {signal.SIGRTMIN + 1}$"),
        ("_exit", "status 0"),
    ],
)
def test_a_worker_that_ends_is_replaced(how, says):
    with Processes(1) as executor:
        end = end_of(executor, partial(calls.leave, how))
        assert isinstance(end, Lost)
        assert re.search(says, end.how)
        assert end_of(executor, partial(calls.double, 1)) == Returned(2)
        with pytest.raises(UserError, match=says.rstrip("$")):
            list(run_all(executor, [partial(calls.leave, how)]))


@pytest.mark.parametrize(("how", "says"), [("shy", "Shy: 1 and 2"), ("closure", "lambda")])
def test_what_cannot_be_sent_back_is_told(how, says):
    with Processes(1) as executor:
        end = end_of(executor, partial(calls.leave, how))
        assert isinstance(end, Failed)
        assert says in str(end.error)


def test_the_first_error_of_many_is_raised_here():
    with local(2) as executor, pytest.raises(ValueError, match="no air"):
        list(run_all(executor, [partial(calls.leave, "raise"), calls.hang]))


def test_a_worker_keeps_its_memory_until_it_is_cancelled_or_the_context_is_left():
    with Processes(2) as executor:
        one = end_of(executor, calls.settings)
        assert end_of(executor, partial(calls.remember, 1)) == Returned([1])
        assert end_of(executor, partial(calls.remember, 2)) == Returned([1, 2])
        executor.submit(0, calls.hang)
        assert list(executor.free()) == [1]
        executor.cancel(0)
        assert list(executor.free()) == [0, 1]
        assert not alive(one.value[0])
        assert end_of(executor, partial(calls.remember, 3)) == Returned([3])
        pid = end_of(executor, calls.settings).value[0]
        executor.submit(1, calls.hang)
    assert not alive(pid)


def test_a_worker_that_dies_between_two_calls_is_replaced():
    with Processes(1) as executor:
        pid = end_of(executor, calls.settings).value[0]
        os.kill(pid, signal.SIGKILL)
        # Its first thread is gone before the others are, and only with them its end can be seen.
        until(lambda: os.waitid(os.P_PID, pid, os.WEXITED | os.WNOHANG | os.WNOWAIT), "its end")
        assert end_of(executor, partial(calls.double, 1)) == Returned(2)


def test_workers_have_one_thread_and_the_caller_keeps_its_own(monkeypatch):
    torch = pytest.importorskip("torch")
    monkeypatch.setenv("OMP_NUM_THREADS", "2")
    before, handler = torch.get_num_threads(), signal.getsignal(signal.SIGINT)
    torch.set_num_threads(2)
    try:
        for workers in (0, 1):
            with local(workers) as executor:
                assert end_of(executor, torch.get_num_threads) == Returned(1)
                (pid, omp, mkl, _) = end_of(executor, calls.settings).value
                assert (pid == os.getpid()) == (workers == 0)
                if workers:
                    assert (omp, mkl) == ("1", "1")
        assert torch.get_num_threads() == 2
    finally:
        torch.set_num_threads(before)
    assert os.environ["OMP_NUM_THREADS"] == "2"
    assert signal.getsignal(signal.SIGINT) is handler
    assert signal.SIGINT not in signal.pthread_sigmask(signal.SIG_BLOCK, ())


PARENT = """
import sys
from pathlib import Path
sys.path.insert(0, sys.argv[1])
import calls
from functools import partial
from faultpath.run.work.executor import run_all
from faultpath.run.work.processes import local
with local(1) as executor:
    list(run_all(executor, [partial(calls.hang, Path(sys.argv[2]) / "log")]))
"""


@pytest.mark.parametrize("how", [signal.SIGKILL, signal.SIGTERM, signal.SIGINT])
def test_workers_end_with_their_parent_however_it_ends(how, tmp_path):
    command = [sys.executable, "-c", PARENT, str(Path(__file__).parent), str(tmp_path)]
    with subprocess.Popen(command, stderr=subprocess.DEVNULL, start_new_session=True) as parent:
        until(lambda: list(tmp_path.glob("*.pid")), "a worker")
        (pid,) = (int(path.stem) for path in tmp_path.glob("*.pid"))
        assert alive(pid)
        # Ctrl-C of a terminal reaches parent and workers alike
        (os.killpg if how == signal.SIGINT else os.kill)(parent.pid, how)
    until(lambda: not alive(pid), "its end")
