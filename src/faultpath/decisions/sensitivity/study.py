"""Which errors are drawn, and the trials under them: one row of the design is one arm."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import PurePath

import numpy as np
from scipy.special import ndtri

from faultpath.core.errors import UserError
from faultpath.core.text import listed, unknown
from faultpath.decisions.analysis import Analysis, Round, Rounds
from faultpath.decisions.planning import rows_of, scenes_of
from faultpath.decisions.question import resolve
from faultpath.decisions.sensitivity.decide import conclude
from faultpath.decisions.sensitivity.model import (
    ResolvedSensitivity,
    SensitivityRecord,
    Uncertain,
    UncertainSource,
)
from faultpath.decisions.sources import NOT_DEPLOYED, channels_of, groups_of
from faultpath.faults import Fault, FaultText
from faultpath.faults.values import Offset, Scale
from faultpath.interface import Uncertainty
from faultpath.statistics.inputs import Floats
from faultpath.statistics.sobol import design
from faultpath.trials import (
    Deliveries,
    Library,
    Outcome,
    OutcomeTable,
    Status,
    Study,
    System,
    SystemSpec,
    Variant,
)
from faultpath.trials.question import SensitivityQuestion

_MOST_COMPONENTS = 16
"""Most components of a vector whose components err each by itself."""
_EDGE = 1e-9
"""Normal errors stop about six standard deviations out."""


@dataclass(frozen=True)
class SensitivityPlan(Analysis[None]):
    """A question, and its trials."""

    request: SensitivityQuestion
    question: ResolvedSensitivity
    study: Study = field(repr=False)

    def rounds(self) -> Rounds[None]:
        """Yield the only round."""
        points, groups = self.question.points, len(self.question.groups)
        trials = len(self.study.arms()) * len(self.study.scenes)
        notice = f"{points} points of {groups} groups of sources: {trials} trials at most."
        yield Round(self.study, notice=notice)

    def conclude(
        self, table: OutcomeTable, deliveries: Deliveries, items: None = None
    ) -> SensitivityRecord:
        """Return the record. `UserError` where no scene is left."""
        failed, findings = len(table.failed()), deliveries.findings
        return conclude(self.question, *self.values(table), failed, findings)

    def values(self, table: OutcomeTable) -> tuple[Floats, int]:
        """Return the mean of what is explained at each row of the design, and how many scenes
        it is over: those in which all trials are sound.

        `UserError` where no scene is left.
        """
        question = self.question
        trials: list[list[list[float]]] = []
        for path in dict.fromkeys(row.path for row in self.study.rows):
            arms = [table.arm(question.variant, path, seed) for seed in question.seeds]
            trials.append([[_value(row.outcome, question.metric) for row in arm] for arm in arms])
        every = np.array(trials).mean(axis=1)  # rows of the design by scenes
        sound = np.isfinite(every).all(axis=0)
        if not sound.any():
            raise UserError(
                f"no scene is left in which every trial has {question.said}: see what failed, or "
                "leave --metric out."
            )
        return every[:, sound].mean(axis=1), int(sound.sum())


def _value(outcome: Outcome, metric: str) -> float:
    if outcome.failed:
        return np.nan
    if metric:
        value = outcome.metrics.get(metric)
        return np.nan if value is None else value
    return 100.0 * (outcome.status is Status.SUCCESS)


def plan_sensitivity(
    system: System, spec: SystemSpec, request: SensitivityQuestion, library: Library
) -> SensitivityPlan:
    """Lay out the design. `UserError` for anything that cannot be run or means nothing."""
    if request.variant not in system.variants:
        raise UserError(f"{system.name}: {unknown('variant', request.variant, system.variants)}")
    if request.metric and request.metric not in system.metrics:
        raise UserError(f"{system.name}: {unknown('metric', request.metric, system.metrics)}")
    variant = system.variants[request.variant]
    groups, left_out = uncertain(system, variant, request.fault)
    if len(groups) < 2:
        names = listed(group.name for group in groups)
        raise UserError(
            f"{system.name}: two groups of sources that err are the least to compare, and "
            f"{request.variant} has {names}; {listed(left_out)} declare no error: declare it in "
            "the interface, or give the largest error with --fault."
        )
    scenes = scenes_of(library, request.scenes)
    rows = design([group.numbers for group in groups], request.points, request.design_seed)
    arms = [
        row
        for number, drawn in enumerate(rows)
        for faults in [{request.variant: tuple(faults_at(system, variant, groups, drawn))}]
        for row in rows_of(f"row {number}", faults, request.seeds)
    ]
    metric = system.metrics[request.metric] if request.metric else None
    question = resolve(
        ResolvedSensitivity,
        request,
        spec,
        library,
        groups=groups,
        left_out=left_out,
        said=metric.said(request.metric) if metric else "success",
        unit=metric.unit if metric else "%",
        n_scenes=len(scenes),
    )
    study = Study(
        name=f"{spec.name}-sensitivity-{request.variant}",
        system=spec,
        library=request.library,
        scenes=scenes,
        rows=tuple(arms),
    )
    named = (
        study.name,
        request.metric or "success",
        *request.fault,
        f"{request.points}-points-seed-{request.design_seed}",
        PurePath(request.library).stem,
    )
    return SensitivityPlan(request, question, system, named, study)


def uncertain(
    system: System, variant: Variant, texts: Sequence[str]
) -> tuple[tuple[Uncertain, ...], tuple[str, ...]]:
    """Return the groups of sources that err, and the sources read that declare no error.

    A fault of `texts` takes the place of what its channel's source, or its group, declares: its
    size is the largest error, of either sign. `UserError` for one that says something else.
    """
    interface = system.interface
    deployed = [source for source in interface.sources if source.provenance not in NOT_DEPLOYED]
    feeds = {s.name: channels_of(interface, (variant,), s.name) for s in deployed}
    members = groups_of(source for source in deployed if feeds[source.name])
    sizes = dict(_given(text) for text in texts)
    unread = {*sizes}
    groups, left_out = list[Uncertain](), list[str]()
    for name, sources in members.items():
        parts: list[UncertainSource] = []
        for source in sources:
            channels = feeds[source.name]
            named = [key for key in (*channels, source.name, name) if key in sizes]
            unread -= {*named}
            error = sizes[named[0]] if named else source.uncertainty
            if error is not None and error.expected_std > 0.0:
                parts.append(UncertainSource(source=source.name, channels=channels, error=error))
            elif error is None:
                left_out.append(source.name)
        if parts:
            shape = sources[0].shape
            alone = len(sources) == 1 and len(shape) == 1 and shape[0] <= _MOST_COMPONENTS
            groups.append(
                Uncertain(name=name, parts=tuple(parts), numbers=shape[0] if alone else 1)
            )
    if unread:
        grouped = (source for sources in members.values() for source in sources)
        known = [channel for source in grouped for channel in feeds[source.name]]
        raise UserError(f"--fault: {unknown('channel', min(unread), [*known, *members])}")
    return tuple(groups), tuple(left_out)


def _given(text: str) -> tuple[str, Uncertainty]:
    parsed = FaultText.read(text)
    try:
        (size,) = map(float, parsed.sizes)
        if parsed.kind not in ("scale", "offset") or parsed.consumers or parsed.options:
            raise ValueError
        relative = parsed.kind == "scale"
        half_range = abs(size - 1.0) if relative else abs(size)
        return parsed.name, Uncertainty(half_range=half_range, relative=relative)
    except ValueError:
        raise UserError(
            f"--fault {text}: give the largest error of a source, as `gain:scale=1.1` for a tenth "
            "of either sign, or `velocity:offset=0.1` in its unit."
        ) from None


def faults_at(
    system: System, variant: Variant, groups: Sequence[Uncertain], drawn: Floats
) -> Iterator[Fault]:
    """Yield the faults at a point of the unit cube, each at all who read its source."""
    left = iter(drawn.tolist())
    for group in groups:
        shares = np.array([next(left) for _ in range(group.numbers)])
        for part in group.parts:
            error = part.error
            if error.half_range is not None:
                sizes = (2.0 * shares - 1.0) * error.half_range
            else:
                sizes = ndtri(np.clip(shares, _EDGE, 1.0 - _EDGE)) * error.expected_std
            numbers = tuple(float(size) for size in sizes + (1.0 if error.relative else 0.0))
            value = numbers if group.numbers > 1 else numbers[0]
            act = Scale(factor=value) if error.relative else Offset(by=value)
            for channel in part.channels:
                fault = Fault(channel=channel, intervention=act)
                yield from fault.resolved(system.interface, variant.consumers)
