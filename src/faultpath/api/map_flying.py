"""Flying a map: round after round, each from what those before have shown; then its record."""

from collections.abc import Callable
from dataclasses import replace

from faultpath.api.job import Job
from faultpath.api.run import MAP_MADE_FROM
from faultpath.api.saved import MAP
from faultpath.decisions import RunProvenance
from faultpath.decisions.map.decide import conclude
from faultpath.decisions.map.lattice import COARSE, lattice
from faultpath.decisions.map.model import MapRecord
from faultpath.decisions.map.study import MapPlan
from faultpath.decisions.map.surface import next_points
from faultpath.trials.store import write_text
from faultpath.trials.work import Progress

_BISECTING = 18
"""Points that are typically added to bisect the paths of the fault."""
_KEPT = "Kept "


def fly_map(plan: MapPlan, job: Job) -> tuple[MapRecord, RunProvenance]:
    """Run the points of a map, round after round, each from what those before have shown; decide,
    and write what its pages are made from.

    Raises `Stopped` on Ctrl-C, and `UserError` where nothing is left to compare.
    """
    asked, points, computed, display = plan.question, list(lattice(COARSE)), 0, job.display
    if plan.system.backend:
        display.say(f"Computing with {plan.system.backend}.")
    study = plan.study(points)
    first = len(study.rows) * len(plan.scenes)
    most = max(len(points), asked.points + _BISECTING) / len(points)
    display.say(
        f"{len(points)} pairs of errors first, {first} trials; then more where the sign is not "
        f"decided, about {round(first * most)} trials at most."
    )
    say = _Once(display.say)
    with display.progress("Running") as show:

        def note(now: Progress) -> None:
            most = max(len(points), asked.points + _BISECTING) / len(points)
            remark = f"{len(points)} pairs of errors"
            show(now.within(max(now.done, (now.total or 0.0) * most), remark=remark))

        while True:
            result = job.run(
                plan.study(points), plan.system, note, notice=say, shared=True, recheck=False
            )
            say.next_round()
            computed += result.blocks_computed
            found = plan.differences(points, plan.compared(points, result.outcomes))
            new = next_points(found, asked.against, asked.points, asked.library_hash)
            if not new:
                break
            points += new
        result = job.run(plan.study(points), plan.system, note, notice=say, shared=True)
        trials = len(result.outcomes.rows)
        show(Progress(trials, trials, f"{len(points)} pairs of errors"))
    blocks = result.blocks_kept + result.blocks_computed
    result = replace(result, blocks_computed=computed, blocks_kept=blocks - computed)
    record = conclude(plan, points, result.outcomes, result.findings)
    write_text(job.folder / MAP, record.model_dump_json(indent=1) + "\n", job.folder)
    return record, job.finish(result, plan.system, MAP_MADE_FROM)


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
