"""Plan an audit: which arms a question about a repair needs, on which paths of the fault."""

from collections.abc import Sequence
from dataclasses import dataclass

from faultpath.errors import UserError
from faultpath.faults import AnyFault
from faultpath.paths import arm_struck, path_struck, strikes_of
from faultpath.record import (
    DecisionRecord,
    Generalise,
    Path,
    Question,
    StopRule,
    StopWhen,
    StruckTap,
    decide,
    primary_path,
    stops,
)
from faultpath.statistics import IN_FORCE, RuleName
from faultpath.streams import generator
from faultpath.taps import TapCount
from faultpath.text import unknown
from faultpath.trials import (
    Deliveries,
    Library,
    OutcomeTable,
    Row,
    Study,
    System,
    SystemSpec,
    Variant,
)

LOOK = 5
"""Scenes from one look to the next of a sequential audit, where the system flies as many at once:
fewer save few trials and cost much for systems that fly their scenes together."""
_ORDER_SEED = 0
"""One order for each library, so that nobody can choose among several."""


@dataclass(frozen=True)
class Audit:
    """A question and the study that answers it."""

    question: Question
    paths: tuple[Path, ...]
    study: Study

    def conclude(self, table: OutcomeTable, deliveries: Deliveries) -> DecisionRecord:
        """Return the decision record of a run; raises as `faultpath.record.decide`."""
        asked = self.question
        paths = [
            path.model_copy(
                update={
                    "struck": struck_taps(deliveries.at(asked.repair, path.name)),
                    "baseline_struck": struck_taps(deliveries.at(asked.baseline, path.name)),
                }
            )
            for path in self.paths
        ]
        return decide(asked, paths, table, findings=deliveries.findings)

    def stops(self, table: OutcomeTable) -> bool:
        """Return whether a sequential audit ends with these trials."""
        return stops(self.question, self.paths, table)


def struck_taps(counts: Sequence[TapCount]) -> tuple[StruckTap, ...]:
    """Return the taps at which receipts show a fault in force."""
    return tuple(
        StruckTap(
            channel=tap.channel,
            consumer=tap.consumer,
            struck_steps=tap.struck_steps,
            altered_steps=tap.altered_steps,
        )
        for tap in counts
        if tap.struck_steps
    )


def plan_audit(
    system: System,
    spec: SystemSpec,
    *,
    baseline: str,
    repair: str,
    fault: AnyFault,
    fault_text: str,
    library: Library,
    scenes: int | None = None,
    seeds: Sequence[int] = (0,),
    primary: str | None = None,
    generalise: Generalise = "scenes",
    metric: str = "",
    thresholds: Sequence[float] = (),
    stop_when: StopWhen | None = None,
    margin_pp: float | None = None,
    rule: RuleName = IN_FORCE,
) -> Audit:
    """Lay out the arms: both variants under correct inputs, under the fault at each module that
    reads it alone, and under the fault shared by all of them.

    `scenes` takes the first N of the library. `primary` is the path that leads the headline;
    by default the shared one, or the only isolated one. `generalise` to `models` speaks of newly
    trained models too. `metric` is told beside success, and success anew at `thresholds` of it.
    `stop_when` makes the audit sequential: scenes come in a random order, and `scenes` is the most
    that it takes; `margin_pp` is what counts as no difference then. `rule` decides; another than
    that in force is for scenes that were seen under it.

    Raises `UserError` for an unknown variant or metric, a repair that is its own baseline, a number
    of scenes that the library does not have, no seed, a fault that reaches neither variant, a
    primary path that does not exist, newly trained models of a system that trains none, from one
    seed or in a sequential audit, or a margin that is none.
    """
    variants = [variant_of(system, name) for name in (baseline, repair)]
    if baseline == repair:
        raise UserError(f"baseline and repair are both '{repair}': name two different variants.")
    if primary is not None and not primary:
        raise UserError("the primary path is empty: name a module or shared, or leave it out.")
    chosen = scenes_of(library, scenes, in_order=stop_when is None)
    if not seeds or len(set(seeds)) < len(seeds):
        raise UserError("give at least one seed, each of them once.")
    strikes = strikes_of(system.interface, fault, variants)
    paths = [
        path_struck(name, system.interface, struck, variants) for name, struck in strikes.items()
    ]
    rows = [
        Row(
            variant=variant.name,
            path=path,
            seed=seed,
            arm=arm_struck(system, variant, struck, seed),
        )
        for path, struck in strikes.items()
        for variant in variants
        for seed in seeds
    ]
    if generalise == "models":
        _check_trainings(system, seeds, stop_when)
    study = Study(
        name=f"{spec.name}-{repair}-vs-{baseline}",
        system=spec,
        library=library.name,
        scenes=chosen,
        rows=tuple(rows),
        look=min(LOOK, system.block_size) if stop_when else 0,
    )
    question = Question(
        system=spec.name,
        options=spec.options,
        baseline=baseline,
        repair=repair,
        fault=fault_text,
        faults=fault.resolved(system.interface),
        library=library.name,
        library_hash=library.content_hash,
        n_scenes=len(chosen),
        seeds=tuple(seeds),
        primary=primary_path(primary or "", paths),
        generalise=generalise,
        trained=system.trained,
        ends={status.value: words for status, words in system.ends.items()},
        metrics=dict(system.metrics),
        metric=_metric(system, metric, thresholds),
        thresholds=tuple(sorted(set(thresholds))),
        stop=_stop_rule(stop_when, margin_pp, study),
        rule=rule,
    )
    return Audit(question, tuple(paths), study)


def _metric(system: System, name: str, thresholds: Sequence[float]) -> str:
    if thresholds and not name:
        raise UserError("thresholds of what? Name a metric of the system beside them.")
    if name and name not in system.metrics:
        raise UserError(f"{system.name}: {unknown('metric', name, system.metrics)}")
    if any(each - each != 0 for each in thresholds):
        raise UserError("a threshold is not finite: give numbers.")
    return name


def _stop_rule(when: StopWhen | None, margin_pp: float | None, study: Study) -> StopRule | None:
    if margin_pp is not None and not (when and 0.0 < margin_pp < 100.0):
        raise UserError(
            f"a margin of {margin_pp:g} pp says when a sequential audit counts a difference as "
            "none: give it with --stop-when, between 0 and 100."
        )
    if when is None:
        return None
    return StopRule(
        when=when,
        margin_pp=margin_pp,
        order=study.scenes,
        order_seed=_ORDER_SEED,
        look=study.look,
        trials=len(study.arms()),
    )


def _check_trainings(system: System, seeds: Sequence[int], stop_when: StopWhen | None) -> None:
    if stop_when:
        raise UserError(
            "no test of newly trained models holds wherever one stops: leave --stop-when or "
            "--generalise models out."
        )
    if not system.trained:
        raise UserError(
            f"{system.name} has no trained models to generalise to: leave --generalise models out."
        )
    if len(seeds) < 2:
        raise UserError(
            "one seed says nothing about newly trained models: give several, such as "
            "--seeds 0,1,2, "
            "or leave --generalise models out."
        )


def variant_of(system: System, name: str) -> Variant:
    """Return a variant by its name; `UserError` for an unknown one."""
    if name not in system.variants:
        raise UserError(f"{system.name}: {unknown('variant', name, system.variants)}")
    return system.variants[name]


def scenes_of(library: Library, count: int | None, in_order: bool = True) -> tuple[str, ...]:
    """Return the first scenes of a library, in its order or the random one of sequential audits;
    `UserError` for a number that it has not got."""
    available = len(library.scenes)
    if count is not None and not 1 <= count <= available:
        raise UserError(
            f"cannot run {count} scenes of library '{library.name}': choose 1 to {available}."
        )
    scenes = library.scenes
    if not in_order:
        stream = generator("scene order", library.content_hash, _ORDER_SEED)
        drawn: list[int] = stream.permutation(available).tolist()
        scenes = tuple(scenes[place] for place in drawn)
    return tuple(scene.id for scene in scenes[:count])
