"""Entry point of the `faultpath` command: what becomes of errors.

It imports next to nothing itself, so that Ctrl-C while the rest loads ends in a sentence as well.
"""

import faulthandler
import os
import re
import signal
import sys
import warnings
from io import TextIOWrapper
from traceback import format_exception
from types import FrameType
from typing import NoReturn

from faultpath.core.errors import Stopped
from faultpath.core.text import one_line, show_warning

USER_ERROR = 2
INTERRUPTED = 130
"""Exit status that shells report for a program that Ctrl-C ended."""

EXIT_BROKEN_PIPE = 141
"""Exit status that shells report for a program that nobody reads any more."""

_TRACEBACK = "--traceback"
_NO_ROOM = re.compile(r"failed to map segment|[Cc]annot allocate")
"""Words of the loader of shared libraries."""
_AGAIN = "interrupted; the same command goes on from what is stored."


def main() -> NoReturn:
    """Run the command line; a user's mistake ends in one sentence and status 2.

    So does an error in the code of a user's system. An error of faultpath's own code keeps
    its traceback; `faultpath.core.error_source` tells the two apart.
    """
    argv = sys.argv[1:]
    end = argv.index("--") if "--" in argv else len(argv)
    traced = _TRACEBACK in argv[:end]
    arguments = [part for part in argv[:end] if part != _TRACEBACK] + argv[end:]
    _prepare_output()
    ctrl_c = _CtrlC()
    if traced and sys.stderr is sys.__stderr__:
        faulthandler.enable()
    shown, warnings.showwarning = warnings.showwarning, show_warning
    try:
        status = _run(arguments)
    except BaseException as error:
        ctrl_c.ignore()
        try:
            status = _explain(error, ctrl_c.pressed, traced)
        except BrokenPipeError:
            status = EXIT_BROKEN_PIPE
        except OSError:  # standard error takes nothing, as on a full disk
            status = USER_ERROR
        if status is None:
            raise
        _flush()
    finally:
        ctrl_c.leave()
        warnings.showwarning = shown
    sys.exit(status)


def _prepare_output() -> None:
    """Let every text be written, to whatever the caller opened for it."""
    for name in ("stdout", "stderr"):
        stream = getattr(sys, name)
        if stream is None:  # it is closed
            setattr(sys, name, os.fdopen(os.open(os.devnull, os.O_WRONLY), "w"))
        elif isinstance(stream, TextIOWrapper):  # to a terminal that has not all letters, too
            stream.reconfigure(errors="backslashreplace")
    if os.environ.get("COLUMNS") == "0":  # rich draws nothing on a terminal of no columns
        del os.environ["COLUMNS"]


def _flush() -> None:
    """Let what is left of the output go nowhere where nothing takes it."""
    for stream in (sys.stdout, sys.stderr):
        try:
            stream.flush()
        except OSError:
            os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())


def _explain(error: BaseException, pressed: int, traced: bool) -> int | None:
    """Say why a command ended, and return its exit status; `None` for an error of faultpath's own.

    Raises `BrokenPipeError` where nobody reads that.
    """
    from faultpath.core.error_source import location

    theirs = bool(location(error))  # a system may raise what would mean something of ours
    # Whoever reads our output has seen enough; rich ends the program at that.
    if BrokenPipeError in (type(error), type(error.__context__)) and not theirs:
        return EXIT_BROKEN_PIPE
    interrupted = isinstance(error, KeyboardInterrupt) and not theirs
    if pressed or interrupted or isinstance(error, Stopped):
        sentence = str(error) if isinstance(error, Stopped) else _AGAIN
        status = 128 + pressed if pressed else INTERRUPTED
    else:
        sentence, status = _sentence(error), USER_ERROR
        if sentence is None:
            return None
        if traced:
            sys.stderr.write("".join(format_exception(error)))
    if sentence:
        sys.stderr.write(f"faultpath: {one_line(sentence)}\n")
    return status


class _CtrlC:
    """Remembers that Ctrl-C was pressed, or SIGTERM sent: libraries that it stops while they load
    raise errors of other kinds."""

    def __init__(self) -> None:
        self.pressed = 0
        usual = {signal.SIGINT: signal.default_int_handler, signal.SIGTERM: signal.SIG_DFL}
        self._before = {n: was for n, was in usual.items() if signal.getsignal(n) is was}
        for number in self._before:
            signal.signal(number, self._press)

    def _press(self, number: int, frame: FrameType | None) -> None:
        self.pressed = number
        raise KeyboardInterrupt

    def ignore(self) -> None:
        """Let what was pressed once more not spoil the sentence about the first time."""
        for number in self._before:
            signal.signal(number, signal.SIG_IGN)

    def leave(self) -> None:
        for number, handler in self._before.items():
            signal.signal(number, handler)


def _run(arguments: list[str]) -> int:
    """Run a verb; typer would catch some errors by itself, so it only parses and calls."""
    import typer

    from faultpath.cli.app import build
    from faultpath.cli.options import as_written, check_arguments
    from faultpath.core.error_source import location

    check_arguments(arguments)
    command = typer.main.get_command(build(arguments))
    as_written(command)
    try:
        with command.make_context("faultpath", arguments) as context:
            status = context.command.invoke(context)
    except typer.Exit as end:
        if location(end):
            raise
        status = end.exit_code
    return status if isinstance(status, int) else 0


def _sentence(error: BaseException) -> str | None:
    """Return what to tell the user; nothing to say where the help is shown already, and `None`
    for an error of faultpath's own."""
    from typer import TyperException

    from faultpath.core.error_source import described, explained

    if isinstance(error, TyperException):  # from the parser of the arguments
        # What typer reads by pydantic has pydantic's own words before the sentence.
        text = error.format_message().replace("Value error, ", "").replace(". Did you", ", did you")
        text = text.strip().rstrip(".").replace(". ", ": ")
        if not text:
            return ""
        text = re.sub(r" \(Possible options: (.*)\)$", r", did you mean \1?", text)
        command = getattr(getattr(error, "ctx", None), "command_path", "faultpath")
        return f"{text[0].lower()}{text[1:]}; `{command} --help` shows what there is."
    loading = isinstance(error, ImportError) and _NO_ROOM.search(str(error))
    mistake = None if loading else explained(error)
    if mistake is not None:
        return str(mistake)
    if isinstance(error, SystemExit):
        return f"what the command ran ends the program ({described(error)}): correct it there"
    if loading or isinstance(error, MemoryError):
        return "there is not enough memory: ask for less, or for fewer --workers."
    if isinstance(error, OSError) and error.strerror:
        about = f"{error.filename}: " if error.filename is not None else ""
        text = f"{error.strerror[0].lower()}{error.strerror[1:]}"
        return f"{about}{text}; check the path and the disk."
    return None
