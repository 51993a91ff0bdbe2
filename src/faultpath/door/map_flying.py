"""Flying a map: round after round, each from what those before have shown; then its record."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from faultpath.door.carrying_out import tell_failures
from faultpath.door.display import Display, Now, Show
from faultpath.door.run import MAP_MADE_FROM
from faultpath.door.saved import MAP
from faultpath.errors import Stopped
from faultpath.execution import (
    Interrupted,
    Progress,
    RunResult,
    Stopwatch,
    run_provenance,
    run_study,
)
from faultpath.plane.decide import conclude
from faultpath.plane.grow import next_points
from faultpath.plane.lattice import COARSE, Point, lattice
from faultpath.plane.study import MapPlan
from faultpath.store import write_text
from faultpath.store.sealed import seal
from faultpath.work import Executor

_BISECTING = 18
"""Points that are typically added to bisect the paths of the fault."""
_KEPT = "Kept "


def fly_map(
    plan: MapPlan,
    folder: Path,
    hands: Executor,
    told: Display,
    time_limit_s: float | None,
    share: Path | None = None,
) -> None:
    """Fly, decide and write what the pages of a map are made from; runs share trials in `share`.

    Raises `Stopped` on Ctrl-C, and `UserError` where nothing is left to compare.
    """
    stopwatch = Stopwatch()
    backend = plan.system.backend
    if backend:
        told.say(f"Computing with {backend}.")
    points, result = _Flying(plan, folder, hands, told, time_limit_s, share).fly()
    tell_failures(told, result, folder)
    record = conclude(plan, points, result.outcomes, result.findings)
    write_text(folder / MAP, record.model_dump_json(indent=1) + "\n", folder)
    files = seal(folder, MAP_MADE_FROM)
    provenance = run_provenance(result, stopwatch, told.command, hands, backend, files)
    write_text(folder / "provenance.json", provenance.model_dump_json(indent=2) + "\n", folder)


@dataclass(frozen=True)
class _Flying:
    """Flies the points of a map, round after round, each from what those before have shown."""

    plan: MapPlan
    folder: Path
    hands: Executor
    told: Display
    time_limit_s: float | None
    share: Path | None

    def fly(self) -> "tuple[list[Point], RunResult]":
        """Return the points, and the result of all of them.

        Raises `Stopped` on Ctrl-C, and `UserError` where nothing is left to compare.
        """
        asked, points, computed = self.plan.question, list(lattice(COARSE)), 0
        self._announce(points)
        try:
            with self.told.progress("Flying") as show:
                say = _Once(self.told.say)
                while True:
                    result = self._round(points, show, say)
                    say.next_round()
                    computed += result.blocks_computed
                    compared = self.plan.compared(points, result.outcomes)
                    found = self.plan.differences(points, compared)
                    new = next_points(found, asked.against, asked.points, asked.library_hash)
                    if not new:
                        break
                    points += new
                result = self._round(points, show, say, recheck=True)
                trials = len(result.outcomes.rows)
                show(Now(trials, trials, f"{len(points)} pairs of errors"))
        except Interrupted as stop:
            raise Stopped(
                f"interrupted; {stop.done} blocks are done and kept in {self.folder}: run the same "
                f"{self.told.called} again to resume."
            ) from None
        blocks = result.blocks_kept + result.blocks_computed
        return points, replace(result, blocks_computed=computed, blocks_kept=blocks - computed)

    def _announce(self, points: Sequence[Point]) -> None:
        first = len(self.plan.study(points).rows) * len(self.plan.scenes)
        self.told.say(
            f"{len(points)} pairs of errors first, {first} trials; then more where the sign is not "
            f"decided, about {self._most(points, first)} trials at most."
        )

    def _most(self, points: Sequence[Point], trials: int) -> int:
        most = max(len(points), self.plan.question.points + _BISECTING)
        return round(trials * most / len(points))

    def _round(
        self,
        points: Sequence[Point],
        show: Show,
        say: Callable[[str], None],
        recheck: bool = False,
    ) -> RunResult:
        def note(now: Progress) -> None:
            most = self._most(points, now.trials_total)
            rows = self._most(points, now.rows_total)
            open_, left = now.trials_total - now.trials_estimated, None
            if now.seconds_left is not None and open_ > 0:
                left = now.seconds_left / open_ * (most - now.trials_estimated)
            count = f"{now.rows_done} trials, about {rows} at most"
            show(Now(now.trials_estimated, most, count, left, f"{len(points)} pairs of errors"))

        return run_study(
            self.plan.study(points),
            self.folder,
            progress=note,
            notice=say,
            system=self.plan.system,
            shared=True,
            executor=self.hands,
            time_limit_s=self.time_limit_s,
            recheck=recheck,
            share=self.share,
        )


class _Once:
    """Tells what rounds have to say, the same only once; that they keep trials only the first."""

    def __init__(self, say: Callable[[str], None]) -> None:
        self._say, self._heard = say, set[str]()

    def __call__(self, text: str) -> None:
        key = _KEPT if text.startswith(_KEPT) else text
        if key not in self._heard:
            self._say(text)
            self._heard.add(key)

    def next_round(self) -> None:
        """Note that from now on trials are kept that this invocation has flown."""
        self._heard.add(_KEPT)
