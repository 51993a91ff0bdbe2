"""Where a call shows what it does: a terminal, a notebook, plain lines, or nowhere."""

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
from faultpath.run.work.executor import Progress

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
        """Command or call that the user has to make again to go on."""
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
        console = self.console
        if console is None:
            yield lambda state: None
        elif console.is_terminal or (console.is_jupyter and find_spec("ipywidgets")):
            texts = (TextColumn(f"{{task.fields[{name}]}}") for name in ("count", "left", "remark"))
            count, left, remark = texts
            columns = (TextColumn("{task.description}"), BarColumn(), count, TimeElapsedColumn())
            bar = Bar(*columns, left, remark, console=console)
            task = bar.add_task(what, total=None, count="", left="", remark="")

            def move(state: Progress) -> None:
                bar.start()  # with the first news: what is refused shows no bar
                bar.update(
                    task,
                    completed=state.done,
                    total=state.total,
                    count=state.count,
                    left=_left(state),
                    remark=state.remark,
                )

            try:
                yield move
            finally:
                if bar.live.is_started:
                    bar.stop()
        else:
            began = last = time.monotonic()
            ended = False

            def line(state: Progress) -> None:
                nonlocal last, ended
                moment = time.monotonic()
                ends = state.total is not None and state.done >= state.total
                if ended or not (ends or moment - last >= _LINE_S):
                    return
                last, ended = moment, ends
                left = "" if ends else _left(state)
                parts = (state.count, f"{_clock(moment - began)} so far", left, state.remark)
                text = f"{what}: {', '.join(filter(None, parts))}"
                console.print(text, markup=False, soft_wrap=True)

            yield line


def display(progress: bool | Display, name: str, arguments: Mapping[str, object]) -> Display:
    """Return where a call from Python shows what it does: a notebook's cell, or stderr.

    `name` and `arguments` are what was called, and with what; left out is what is `None` or empty,
    and `progress` itself.
    """
    if isinstance(progress, Display):
        return progress
    parts = (
        f"{key}={(str(value) if key == 'folder' else value)!r}"
        for key, value in arguments.items()
        if key != "progress" and value not in (None, (), {})
    )
    call = f"faultpath.{name}({', '.join(parts)})"
    return Display(SafeConsole(stderr=True) if progress else None, (call,))


def _left(state: Progress) -> str:
    return "" if state.seconds is None else f"{_clock(state.seconds)} left"


def _clock(seconds: float) -> str:
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02d}:{rest:02d}" if hours else f"{minutes}:{rest:02d}"
