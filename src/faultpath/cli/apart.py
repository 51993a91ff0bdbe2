"""The command in a child process, so that a system that ends its process does not end it.

A library that crashes takes its process along, and `os._exit` ends one without a word. The parent,
which does nothing but wait, then says what happened; a thread that a system leaves behind holds
nothing up either. Ctrl-C and what else is sent to the parent reach the child.
"""

import atexit
import mmap
import os
import signal
import sys
import threading
from collections.abc import Callable
from contextlib import suppress
from types import FrameType
from typing import NoReturn

from faultpath.text import one_line

_SENT = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGQUIT)
_LAST_S = 5.0
"""For what a system has registered to be done at the end."""
_OVER, _STATUS, _SIZE = 0, 1, 2
"""Where the parent reads whether the child was done, and with which status."""
_FATAL = 2
_UNREAD = 141


def possible() -> bool:
    """Return whether this process is the command's own: nobody has replaced its streams, and no
    thread would be lost in a child."""
    whole = sys.stdout is sys.__stdout__ and sys.stderr is sys.__stderr__
    return hasattr(os, "fork") and whole and threading.active_count() == 1


def run(command: Callable[[], object]) -> NoReturn:
    """Run a command that ends with `SystemExit` in a child, and end as it does."""
    shared, parent = mmap.mmap(-1, _SIZE), os.getpid()
    before = signal.pthread_sigmask(signal.SIG_BLOCK, _SENT)
    child = os.fork()
    if child == 0:
        _die_with(parent)
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
        _work(command, shared)

    def send(number: int, frame: FrameType | None) -> None:
        with suppress(ProcessLookupError):
            os.kill(child, number)

    for each in _SENT:
        if signal.getsignal(each) != signal.SIG_IGN:
            signal.signal(each, send)
    signal.pthread_sigmask(signal.SIG_SETMASK, before)
    code = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
    if shared[_OVER]:
        sys.exit(shared[_STATUS])
    if -code in _SENT:
        signal.signal(-code, signal.SIG_DFL)
        os.kill(parent, -code)
    sys.stderr.write(f"faultpath: {one_line(_obituary(code))}\n")
    sys.exit(_FATAL)


def _obituary(code: int) -> str:
    what = "what the command ran"
    if code >= 0:
        return (
            f"{what} ended the process with status {code} before the command was done: let the "
            "code raise an error in place of os._exit"
        )
    try:
        name = signal.Signals(-code).name
    except ValueError:
        name = "of no name"
    hint = ", often for want of memory" if code == -signal.SIGKILL else ""
    return (
        f"{what} ended the process (signal {-code}, {name}{hint}): correct what crashes there; "
        "--traceback shows where Python was"
    )


def _work(command: Callable[[], object], shared: mmap.mmap) -> NoReturn:
    try:
        command()
        status = 0
    except SystemExit as end:
        status = end.code if isinstance(end.code, int) else int(end.code is not None)
    except BaseException as error:
        sys.excepthook(type(error), error, error.__traceback__)
        status = 1
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # it would change nothing any more
    status = status if _flushed() else _UNREAD
    shared[_STATUS] = status & 0xFF
    shared[_OVER] = 1

    def finish(number: int, frame: FrameType | None) -> NoReturn:
        os._exit(status)

    signal.signal(signal.SIGALRM, finish)
    signal.setitimer(signal.ITIMER_REAL, _LAST_S)
    atexit._run_exitfuncs()  # pyright: ignore[reportPrivateUsage]
    _flushed()
    os._exit(status)


def _flushed() -> bool:
    """Write out what the streams hold; return whether somebody takes it."""
    try:
        sys.stdout.flush()
        sys.stderr.flush()
    except OSError:
        return False
    return True


def _die_with(parent: int) -> None:
    """Let this process be killed when its parent is, where the kernel can do that."""
    if sys.platform == "linux":
        import ctypes

        ctypes.CDLL(None).prctl(1, signal.SIGKILL)  # PR_SET_PDEATHSIG
        if os.getppid() != parent:
            os._exit(1)
