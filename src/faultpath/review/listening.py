"""Trials flown once more by the workers of a run, and what was heard in them."""

import importlib
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from typing_extensions import override

from faultpath.blame import described
from faultpath.errors import SystemMistake
from faultpath.execution.attempt import Done, Raised, Wrong
from faultpath.execution.worker import Brief, building
from faultpath.review.hearing import Heard, Values, fly_heard, laid_out, signals, steps_of
from faultpath.store.signals import TOGETHER, Signal
from faultpath.trials import Arm, Outcome, System
from faultpath.trials.terms import ErrorSum, Recorded

More: TypeAlias = Callable[[System, Heard, Done], list[tuple[Signal, ...]]]
"""What a system says beside what is heard, by scene."""

MORE = {"quadrotor": "faultpath.quadrotor.evidence.signals:quadrotor_signals"}
"""Who says it, by name of the system. They are strings, so that naming one imports nothing."""


@dataclass(frozen=True)
class Listening:
    """An arm over some scenes."""

    arm: Arm
    scenes: tuple[str, ...]


@dataclass(frozen=True)
class Overheard:
    """What came of it, by scene."""

    outcomes: tuple[Outcome, ...] = ()
    signals: tuple[tuple[Signal, ...], ...] = ()
    error: str = ""
    """What kept it from its end."""


def listen(brief: Brief, task: Listening) -> Overheard:
    """Fly in a worker process, which keeps what it has built for the next task."""
    with building(brief) as built:
        return listen_here(built.system, brief.system.name, task)


def listen_here(system: System, name: str, task: Listening) -> Overheard:
    """Fly with a system that is built; `name` is what users call it by."""
    done, heard = fly_heard(system, task.arm, task.scenes)
    if isinstance(done, Raised):
        return Overheard(error=done.error)
    if isinstance(done, Wrong):
        return Overheard(error=str(done.error))
    said = _more(name) if name in MORE else error_signals
    named = zip(signals(heard, done, system.control_dt_s), said(system, heard, done), strict=True)
    return Overheard(done.outcomes, tuple(a + b for a, b in named))


def error_signals(system: System, heard: Heard, done: Done) -> list[tuple[Signal, ...]]:
    """Return the two errors that a system names and their sum, of each scene.

    None where the variant has not got what they are taken from.
    """
    return [
        _errors(system, _Trial(heard, scene, steps))
        for scene, steps in enumerate(steps_of(done, system.control_dt_s))
    ]


def added(topic: str, unit: str, terms: Mapping[str, Values]) -> tuple[Signal, ...]:
    """Return two errors and their sum as signals of one topic."""
    together = np.sum([np.asarray(each, np.float64) for each in terms.values()], axis=0)
    return tuple(
        Signal(name, topic, unit, np.asarray(values, np.float32).reshape(len(together), 1))
        for name, values in {**terms, TOGETHER: together}.items()
    )


def _errors(system: System, trial: Recorded) -> tuple[Signal, ...]:
    errors = getattr(system, "errors", None)
    if not isinstance(errors, ErrorSum):
        return ()
    try:
        return added(
            errors.words, errors.unit, {term.words: term.of(trial) for term in errors.terms}
        )
    except KeyError:
        return ()
    except Exception as error:
        raise SystemMistake(
            f"system '{system.name}': its `errors` cannot be told ({described(error)})"
        ) from error


@dataclass(frozen=True)
class _Trial(Recorded):
    """One scene of what was heard."""

    heard: Heard
    scene: int
    steps: int

    @override
    def held(self, source: str) -> Values:
        return laid_out(self.heard.sources[source], self.scene, self.steps)

    @override
    def got(self, channel: str, consumer: str) -> Values:
        return laid_out(self.heard.got[channel, consumer], self.scene, self.steps)


def _more(name: str) -> More:
    place, _, attribute = MORE[name].partition(":")
    return getattr(importlib.import_module(place), attribute)
