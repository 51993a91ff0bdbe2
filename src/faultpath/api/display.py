"""Where a call tells what it does: a terminal, a notebook, plain lines, or nowhere."""

import logging
import time
from collections.abc import Callable, Generator, Iterable, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from importlib.util import find_spec

from rich.console import Console, ConsoleOptions, RenderableType
from rich.progress import BarColumn, TextColumn, TimeElapsedColumn
from rich.progress import Progress as Bar
from rich.segment import Segment

from faultpath.core.text import printable
from faultpath.trials.work import Progress

Show = Callable[[Progress], None]

_LINE_S = 10.0
"""Seconds between two lines, where no bar can move."""

_log = logging.getLogger("faultpath")


class SafeConsole(Console):
    """A console on which no name that a user or a file gave can steer the terminal."""

    def render(
        self, renderable: RenderableType, options: ConsoleOptions | None = None
    ) -> Iterable[Segment]:
        """Yield what `Console.render` does, with control characters in texts escaped."""
        for segment in super().render(renderable, options):
            if segment.control or segment.text.isprintable():
                yield segment
            else:
                text = "\n".join(map(printable, segment.text.split("\n")))
                yield Segment(text, segment.style)


@dataclass(frozen=True)
class Display:
    """Who is told of a call: by default nobody, and what must be read goes to the log."""

    console: Console | None = None
    command: tuple[str, ...] = ()
    """The command line, or the call from Python as one text."""

    @property
    def is_command(self) -> bool:
        """Whether the command line made the call, so that the process is its own."""
        return len(self.command) > 1

    @property
    def called(self) -> str:
        """What the user has to make again to go on: a command or a call."""
        return "command" if self.is_command else "call"

    def say(self, text: str, style: str | None = None) -> None:
        """Tell a sentence."""
        if self.console is None:
            _log.warning(text)
        else:
            self.console.print(text, markup=False, soft_wrap=True, style=style)

    @contextmanager
    def progress(self, what: str) -> Generator[Show]:
        """Show how far something has come: as a bar that moves, or in a line now and then."""
        if self.console is None:
            yield lambda now: None
        elif self.console.is_terminal or (self.console.is_jupyter and find_spec("ipywidgets")):
            with _bar(self.console, what) as show:
                yield show
        else:
            yield _Lines(self.console, what).show


def display(progress: bool | Display, name: str, given: Mapping[str, object]) -> Display:
    """Return who is told of a call from Python: notebooks in their cell, others on stderr.

    `name` and `given` are what was called, and with what; left out is what is `None` or empty,
    and `progress` itself.
    """
    if isinstance(progress, Display):
        return progress
    said = (
        f"{key}={(str(value) if key == 'folder' else value)!r}"
        for key, value in given.items()
        if key != "progress" and value not in (None, (), {})
    )
    call = f"faultpath.{name}({', '.join(said)})"
    return Display(SafeConsole(stderr=True) if progress else None, (call,))


def _left(seconds: float | None) -> str:
    """Say how long it will still take, where that is known."""
    return "" if seconds is None else f"{_clock(seconds)} left"


@contextmanager
def _bar(console: Console, what: str) -> Generator[Show]:
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        TextColumn("{task.fields[count]}"),
        TimeElapsedColumn(),
        TextColumn("{task.fields[left]}"),
        TextColumn("{task.fields[remark]}"),
    )
    bar = Bar(*columns, console=console)
    task = bar.add_task(what, total=None, count="", left="", remark="")

    def show(now: Progress) -> None:
        bar.start()  # with the first news: what is refused shows no bar
        bar.update(
            task,
            completed=now.done,
            total=now.total,
            count=now.count,
            left=_left(now.seconds),
            remark=now.remark,
        )

    try:
        yield show
    finally:
        if bar.live.is_started:
            bar.stop()


class _Lines:
    """Progress where no line can be written over: one now and then, and one at the end."""

    def __init__(self, console: Console, what: str) -> None:
        self._console = console
        self._what = what
        self._began = self._last = time.monotonic()
        self._ended = False

    def show(self, now: Progress) -> None:
        moment = time.monotonic()
        ends = now.total is not None and now.done >= now.total
        if self._ended or not (ends or moment - self._last >= _LINE_S):
            return
        self._last, self._ended = moment, ends
        so_far, left = f"{_clock(moment - self._began)} so far", "" if ends else _left(now.seconds)
        parts = (now.count, so_far, left, now.remark)
        line = f"{self._what}: {', '.join(filter(None, parts))}"
        self._console.print(line, markup=False, soft_wrap=True)


def _clock(seconds: float) -> str:
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02d}:{rest:02d}" if hours else f"{minutes}:{rest:02d}"
