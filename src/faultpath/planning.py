"""Plan an audit: which arms a question about a repair needs, on which paths of the fault."""

from collections.abc import Sequence
from dataclasses import dataclass

from faultpath.errors import UserError
from faultpath.faults import AnyFault, Fault
from faultpath.interface import Interface, module_of
from faultpath.record import (
    CORRECT,
    SHARED,
    DecisionRecord,
    Generalise,
    Path,
    Question,
    StruckTap,
    decide,
    primary_path,
)
from faultpath.taps import TapCount
from faultpath.text import unknown
from faultpath.trials import (
    Arm,
    Deliveries,
    Library,
    OutcomeTable,
    Row,
    Study,
    System,
    SystemSpec,
    Variant,
)


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
) -> Audit:
    """Lay out the arms: both variants under correct inputs, under the fault at each module that
    reads it alone, and under the fault shared by all of them.

    `scenes` takes the first N of the library. `primary` is the path that leads the headline;
    by default the shared one, or the only isolated one. `generalise` to `models` speaks of newly
    trained models too. `metric` is told beside success, and success anew at `thresholds` of it.

    Raises `UserError` for an unknown variant or metric, a repair that is its own baseline, a number
    of scenes that the library does not have, no seed, a fault that reaches neither variant, a
    primary path that does not exist, or newly trained models of a system that trains none or from
    one seed.
    """
    variants = [variant_of(system, name) for name in (baseline, repair)]
    if baseline == repair:
        raise UserError(f"baseline and repair are both '{repair}': name two different variants.")
    chosen = scenes_of(library, scenes)
    if not seeds or len(set(seeds)) < len(seeds):
        raise UserError("give at least one seed, each of them once.")
    strikes = _strikes(system.interface, fault, variants)
    paths = [_path(name, system.interface, struck, variants) for name, struck in strikes.items()]
    rows = [
        Row(variant=variant.name, path=path, seed=seed, arm=_arm(system, variant, struck, seed))
        for path, struck in strikes.items()
        for variant in variants
        for seed in seeds
    ]
    if generalise == "models":
        _check_trainings(system, seeds)
    question = Question(
        system=spec.name,
        options=spec.options,
        baseline=baseline,
        repair=repair,
        fault=fault_text,
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
    )
    study = Study(
        name=f"{spec.name}-{repair}-vs-{baseline}",
        system=spec,
        library=library.name,
        scenes=chosen,
        rows=tuple(rows),
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


def _check_trainings(system: System, seeds: Sequence[int]) -> None:
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


def scenes_of(library: Library, count: int | None) -> tuple[str, ...]:
    """Return the first scenes of a library; `UserError` for a number that it has not got."""
    available = len(library.scenes)
    if count is not None and not 1 <= count <= available:
        raise UserError(
            f"cannot run {count} scenes of library '{library.name}': choose 1 to {available}."
        )
    return tuple(scene.id for scene in library.scenes[:count])


def _strikes(
    interface: Interface, fault: AnyFault, variants: Sequence[Variant]
) -> dict[str, AnyFault | None]:
    """Return the fault of each path; `None` under correct inputs."""
    reached = [c for variant in variants for c in _struck(interface, fault, variant)]
    if not reached:
        names = " nor ".join(f"'{variant.name}'" for variant in variants)
        raise UserError(
            f"the fault ({fault.describe()}) reaches neither {names}: neither reads it there."
        )
    by_module: dict[str, list[str]] = {}
    for consumer in reached:
        places = by_module.setdefault(module_of(consumer), [])
        if consumer not in places:
            places.append(consumer)
    strikes: dict[str, AnyFault | None] = {CORRECT: None}
    for module in sorted(by_module):
        if module in (CORRECT, SHARED):
            raise UserError(
                f"the interface calls a module '{module}', which is the name of a path of every "
                "audit: rename the module."
            )
        strikes[module] = fault.striking(*by_module[module])
    # With a single module there is nothing to share: the isolated fault is all of it.
    if len(by_module) > 1:
        strikes[SHARED] = fault.striking(*(c for places in by_module.values() for c in places))
    return strikes


def _struck(interface: Interface, fault: AnyFault | None, variant: Variant) -> tuple[str, ...]:
    consumers = (c for f in _resolved(interface, fault, variant) for c in f.consumers)
    return tuple(dict.fromkeys(consumers))


def _resolved(interface: Interface, fault: AnyFault | None, variant: Variant) -> tuple[Fault, ...]:
    return () if fault is None else fault.resolved(interface, variant.consumers)


def _path(
    name: str, interface: Interface, fault: AnyFault | None, variants: Sequence[Variant]
) -> Path:
    baseline, repair = variants
    titles = {CORRECT: "Correct inputs", SHARED: "Shared fault"}
    return Path(
        name=name,
        title=titles.get(name, f"{name.replace('_', ' ').capitalize()} only"),
        consumers=_struck(interface, fault, repair),
        baseline_consumers=_struck(interface, fault, baseline),
    )


def _arm(system: System, variant: Variant, fault: AnyFault | None, seed: int) -> Arm:
    """Return the arm with its fault spelled out: where the fault cannot reach the variant, that
    is the arm under correct inputs, which runs once."""
    faults = _resolved(system.interface, fault, variant)
    return Arm(variant=variant.name, faults=faults, seed=seed)
