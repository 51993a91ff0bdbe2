"""Where a sequential study stops: at the first look that says so, whatever was flown beyond it."""

from collections.abc import Callable, Mapping, Sequence

from faultpath.execution.schedule import Unit
from faultpath.trials.arm import Study
from faultpath.trials.declared import Library
from faultpath.trials.outcome import Outcome
from faultpath.trials.table import OutcomeTable, assemble

Stop = Callable[[OutcomeTable], bool]
"""Says of the trials of all looks so far whether they are enough."""


class Looks:
    """The looks of a study, taken in order, each as soon as all of its trials are there.

    So the same trials count whatever the number of workers, and wherever a run was interrupted.
    """

    def __init__(
        self, study: Study, library: Library, units: Sequence[Unit], stop: Stop | None
    ) -> None:
        self._study, self._library, self._units = study, library, units
        self._stop = stop if study.look else None
        self._missing: dict[int, set[tuple[str, str]]] = {}
        for unit in units:
            keys = self._missing.setdefault(unit.block, set())
            keys.update((unit.arm.key(), scene) for scene in unit.scenes)
        self._taken, self._over = 0, False

    def enough(self, outcomes: Mapping[tuple[str, str], Outcome]) -> bool:
        """Take the looks whose trials are all in `outcomes`; return whether the study stops."""
        while self._stop and not self._over and self._taken in self._missing:
            self._missing[self._taken].difference_update(outcomes)
            if self._missing[self._taken]:
                break
            self._taken += 1
            self._over = self._stop(assemble(self.study, self._library, outcomes))
        return self._over

    @property
    def study(self) -> Study:
        """The study, with the scenes of the looks that were taken."""
        if self._stop is None:
            return self._study
        scenes = self._study.scenes[: self._taken * self._study.look]
        return self._study.model_copy(update={"scenes": scenes})

    @property
    def units(self) -> tuple[Unit, ...]:
        """The units whose trials count."""
        if self._stop is None:
            return tuple(self._units)
        return tuple(unit for unit in self._units if unit.block < self._taken)
