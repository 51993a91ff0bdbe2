"""Carrying a fit out on the terminal: progress, notices, the table at the end.

The quadrotor, and torch with it, loads inside the functions.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from rich.progress import (
    BarColumn,
    Progress,
    TaskID,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)
from rich.text import Text

from faultpath.api.display import SafeConsole
from faultpath.core.errors import Stopped
from faultpath.decisions.tables import MISSING, Line, Table, line
from faultpath.decisions.tables.terminal import drawn

if TYPE_CHECKING:
    from faultpath_quadrotor.checkpoint import ModelCard
    from faultpath_quadrotor.training.catalogue import Job
    from faultpath_quadrotor.training.jobs import Failure, Overview


@dataclass(frozen=True)
class TrainRequest:
    """What the command line asked for."""

    names: tuple[str, ...]
    seeds: tuple[int, ...]
    data: Path
    out: Path
    workers: int
    ship: bool


def list_models() -> None:
    """Print what can be fitted."""
    from faultpath_quadrotor.training.catalogue import ALL

    columns = ("seeds", "what it is")
    lines = tuple(line(e.name, ",".join(map(str, e.seeds)), e.description) for e in ALL)
    SafeConsole().print(drawn(Table(corner="model", columns=columns, words=columns, lines=lines)))


def train(request: TrainRequest) -> int:
    """Collect what is missing, fit, print tables; return the number of models that failed.

    Models whose data are flown with other models come in a second stage, after those. Raises
    `Stopped` on Ctrl-C and `UserError` for names that are not known, folders that cannot be used,
    and data that cannot be collected.
    """
    from faultpath.trials.store import make_folder
    from faultpath_quadrotor.training.catalogue import choose, stages
    from faultpath_quadrotor.training.jobs import Failure, check_pilots

    console = SafeConsole()
    failed = 0
    chosen = choose(request.names, request.seeds)
    if not request.ship:
        check_pilots(chosen)
    for place in (request.out, request.data):
        make_folder(place)  # before the flights: what cannot be kept need not be collected
    for jobs in stages(chosen):
        _collect(console, jobs, request)
        found = _fit(console, jobs, request)
        failures = [each for each in found if isinstance(each, Failure)]
        for failure in failures:
            said = f"{failure.job.stem} was not fitted: {failure.error}"
            said += f" ({failure.details})" if failure.details else ""
            console.print(Text(said, style="bold red"), soft_wrap=True)
        cards = [each for each in found if not isinstance(each, Failure)]
        if cards:
            console.print(drawn(result_table(cards), one_line=True))
            console.print(f"Checkpoints: {request.out}", markup=False, soft_wrap=True)
        failed += len(failures)
    return failed


def result_table(cards: Sequence[ModelCard]) -> Table:
    """Return the table of fitted models."""
    columns = ("seed", "parameters", "training loss", "validation", "time")
    lines = tuple(map(_line, cards))
    return Table(title="Fitted models", corner="model", columns=columns, lines=lines)


def _line(card: ModelCard) -> Line:
    metric, value = next(iter(card.final.items()), ("", None))
    return line(
        card.name,
        str(card.seed),
        f"{card.parameters:,}",
        f"{card.training_loss[-1]:.4g}",
        MISSING if value is None else f"{metric} {value:.4g}",
        _duration(card.duration_s),
    )


def _collect(console: SafeConsole, jobs: Sequence[Job], request: TrainRequest) -> None:
    from faultpath_quadrotor.training.jobs import (
        check_pools,
        collect_missing,
        missing_pools,
    )

    check_pools(jobs, request.data)
    missing = missing_pools(jobs, request.data)
    if not missing:
        return
    with _progress(console) as bar:
        tasks = {pool: bar.add_task(f"Collecting {pool}", total=None, news="") for pool in missing}

        def show(pool: str, done: float, asked: float) -> None:
            news = f"{done / max(asked, 1):.0%}"
            bar.update(tasks[pool], total=asked, completed=done, news=news)

        try:
            collect_missing(jobs, request.data, request.workers, show)
        except KeyboardInterrupt:
            raise Stopped(
                f"interrupted while collecting; what was flown is kept in {request.data}; run the "
                "same command again to resume."
            ) from None


def _fit(
    console: SafeConsole, jobs: Sequence[Job], request: TrainRequest
) -> tuple[ModelCard | Failure, ...]:
    from faultpath_quadrotor.training.jobs import run_jobs

    with _progress(console) as bar:
        whole = bar.add_task("Fitting", total=1.0, news="")
        tasks: dict[str, TaskID] = {}

        def show(now: Overview) -> None:
            news = f"{now.done}/{now.total} models"
            bar.update(whole, completed=now.fraction, news=news)
            for stem in set(tasks) - set(now.running):
                bar.remove_task(tasks.pop(stem))
            for stem, moment in now.running.items():
                if stem not in tasks:
                    tasks[stem] = bar.add_task(f"  {stem}", total=1.0, news="")
                if moment is not None:
                    news = f"epoch {moment.epoch + 1}, loss {moment.loss:.4g}"
                    bar.update(tasks[stem], completed=moment.fraction, news=news)

        return run_jobs(
            jobs,
            request.data,
            request.out,
            request.workers,
            show,
            lambda text: bar.console.print(text, markup=False, soft_wrap=True),
            shipped=request.ship,
        )


def _progress(console: SafeConsole) -> Progress:
    return Progress(
        TextColumn("{task.description}"),
        BarColumn(),
        TextColumn("{task.fields[news]}"),
        TimeElapsedColumn(),
        TimeRemainingColumn(),
        TextColumn("left"),
        console=console,
    )


def _duration(seconds: float) -> str:
    minutes, rest = divmod(round(seconds), 60)
    return f"{minutes}:{rest:02d}"
