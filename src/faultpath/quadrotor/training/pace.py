"""How far the fitting of several models is, and how long it will still take."""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from faultpath.quadrotor.training.catalogue import Job
from faultpath.quadrotor.training.fitting import Moment


@dataclass(frozen=True)
class Running:
    """One model at work."""

    stem: str
    fraction: float
    epoch: int
    """Counted from 1."""
    loss: float | None
    """Of a recent minibatch; None until the first."""
    seconds_left: float | None


@dataclass(frozen=True)
class Overview:
    """All models together."""

    done: int
    total: int
    fraction: float
    """Part of the expected time that is done."""
    seconds_left: float | None
    """None until a model has shown its pace."""
    running: tuple[Running, ...]


@dataclass
class _Course:
    """What a job has shown so far: its first news, and its latest."""

    first: tuple[float, float] | None = None
    latest: tuple[float, float] | None = None
    moment: Moment | None = None

    def note(self, now: float, moment: Moment) -> None:
        self.first = self.first or (now, moment.fraction)
        self.latest = (now, moment.fraction)
        self.moment = moment

    def progressed(self) -> tuple[float, float]:
        """Return seconds and the fraction done in them, since the first news."""
        if self.first is None or self.latest is None:
            return 0.0, 0.0
        return self.latest[0] - self.first[0], self.latest[1] - self.first[1]


class Pace:
    """Takes in the news of all jobs and estimates what is left.

    A running job goes on at its own pace; a waiting one is expected to take time in proportion to
    its cost in the catalogue, at the pace that all jobs have shown.
    """

    def __init__(
        self, jobs: Sequence[Job], workers: int, clock: Callable[[], float] = time.monotonic
    ) -> None:
        self._cost = {job.stem: job.entry.cost for job in jobs}
        self._workers = workers
        self._clock = clock
        self._courses: dict[str, _Course] = {}
        self._ended: set[str] = set()

    def start(self, job: Job) -> None:
        """Note that a job is at work."""
        self._courses[job.stem] = _Course()

    def advance(self, job: Job, moment: Moment) -> None:
        """Note how far a job is."""
        self._courses[job.stem].note(self._clock(), moment)

    def end(self, job: Job) -> None:
        """Note that a job has ended, however it did."""
        self._ended.add(job.stem)

    def overview(self) -> Overview:
        """Return the state of everything now."""
        running = tuple(
            self._running(stem, course)
            for stem, course in self._courses.items()
            if stem not in self._ended
        )
        done_of = {each.stem: each.fraction for each in running} | dict.fromkeys(self._ended, 1.0)
        left = sum(cost * (1 - done_of.get(stem, 0.0)) for stem, cost in self._cost.items())
        return Overview(
            done=len(self._ended),
            total=len(self._cost),
            fraction=1 - left / sum(self._cost.values()),
            seconds_left=self._seconds_left(left, running),
            running=running,
        )

    def _running(self, stem: str, course: _Course) -> Running:
        if course.moment is None:
            return Running(stem, 0.0, 1, None, None)
        seconds, fraction = course.progressed()
        moment = course.moment
        left = (1 - moment.fraction) * seconds / fraction if fraction > 0 else None
        return Running(stem, moment.fraction, moment.epoch + 1, moment.loss, left)

    def _seconds_left(self, left: float, running: tuple[Running, ...]) -> float | None:
        """Spread the cost that is left over the workers; the longest running job bounds it."""
        shown = [(c.progressed(), self._cost[stem]) for stem, c in self._courses.items()]
        cost = sum(fraction * weight for (_, fraction), weight in shown)
        if cost <= 0:
            return None
        pace = sum(seconds for (seconds, _), _ in shown) / cost
        return max([left * pace / self._workers, *(each.seconds_left or 0.0 for each in running)])
