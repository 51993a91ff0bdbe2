"""Failures that depend on each other: groups of consumers with one source, and what was run.

The words are those of ISO 26262-1 and -9: an error of the source is the initiator, the coupling
factor is why it reaches several elements. What reaches them by the source itself is a common cause
failure, what reaches them through the output of another one a cascading failure. Nothing here
claims that elements are independent, or free from interference.
"""

from collections.abc import Collection, Iterable, Sequence

from faultpath.core.results import Frozen
from faultpath.decisions.fault_groups import JOINED
from faultpath.decisions.model import SHARED, DecisionRecord, Effect
from faultpath.decisions.sentences.wording import reservation, with_interval
from faultpath.decisions.sources import NOT_DEPLOYED, Wired, bound, expected, groups_of
from faultpath.interface import Interface, Source, module_of

_SIZE = "SIZE"
"""Stands in a command for what no declaration gives."""

Taps = tuple[tuple[str, str], ...]
"""Channels, each with a place that reads it."""


class Evidence(Frozen):
    """Result of one audit on one path."""

    run: str
    """Its folder; empty for the only one."""
    fault: str
    said: str
    """Decision of its family, in words."""
    difference: str
    """The effect with its interval, percentage points."""
    detected: bool
    missed: Taps
    """Taps of the group that its fault did not reach on this path."""


class Way(Frozen):
    """One way in which an error of the group's source acts: at one module, or at all of them."""

    path: str
    taps: Taps
    passed_on: tuple[str, ...]
    """Places that get it through what these modules make, and what is made of that in turn."""
    evidence: tuple[Evidence, ...] = ()


class DependentGroup(Frozen):
    """Consumers whose failures one source, or several that err by one cause, may bring about."""

    name: str
    """Name of the source, or of the correlation group."""
    sources: tuple[str, ...]
    coupling: str
    ways: tuple[Way, ...]
    fault: str
    """As large as the expected error, or with `SIZE` where none is declared."""

    @property
    def modules(self) -> tuple[str, ...]:
        """Those that read it."""
        return tuple(way.path for way in self.ways if way.path != SHARED)


def dependent_groups(interface: Interface, variants: Sequence[Wired]) -> tuple[DependentGroup, ...]:
    """Return the groups of two consumers or more, in the order of declaration.

    Every source counts that exists at deployment, whatever error it declares; a consumer counts
    that reads it in one of the variants, directly or through reconstructions.
    """
    deployed = (source for source in interface.sources if source.provenance not in NOT_DEPLOYED)
    groups: list[DependentGroup] = []
    for name, sources in groups_of(deployed).items():
        taps = _readers(interface, variants, [source.name for source in sources])
        alone: dict[str, list[tuple[str, str]]] = {}
        for channel, consumer in taps:
            alone.setdefault(module_of(consumer), []).append((channel, consumer))
        passed_on = {module: _passed_on(interface, variants, module) for module in alone}
        every = dict.fromkeys(place for module in alone for place in passed_on[module])
        places = {consumer for _, consumer in taps}
        if len(places | set(every)) < 2:
            continue
        ways = [Way(path=m, taps=tuple(alone[m]), passed_on=passed_on[m]) for m in alone]
        if len(alone) > 1:
            ways.append(Way(path=SHARED, taps=taps, passed_on=tuple(every)))
        channels = tuple(dict.fromkeys(channel for channel, _ in taps))
        fault, _ = expected((), name, sources, channels)
        named = channels if sources[0].correlation_group is None else (name,)
        groups.append(
            DependentGroup(
                name=name,
                sources=tuple(source.name for source in sources),
                coupling=_coupling(sources, len(places), bool(every)),
                ways=tuple(ways),
                fault=fault or JOINED.join(f"{name}:scale={_SIZE}" for name in named),
            )
        )
    return tuple(groups)


def _readers(interface: Interface, variants: Sequence[Wired], sources: Collection[str]) -> Taps:
    return tuple(
        (channel.name, consumer)
        for channel in interface.channels
        for consumer in channel.consumers
        if any(
            consumer in variant.consumers and bound(variant, interface, channel.name) in sources
            for variant in variants
        )
    )


def _passed_on(interface: Interface, variants: Sequence[Wired], module: str) -> tuple[str, ...]:
    """Return the places that read what a module makes, and what is made of that, recursively."""
    reached, waiting = dict[str, None](), [module]
    for maker in waiting:  # grows while it is gone through
        outputs = interface.reconstructs.get(maker, ())
        for _, consumer in _readers(interface, variants, outputs):
            reached[consumer] = None
            if module_of(consumer) not in waiting:
                waiting.append(module_of(consumer))
    return tuple(reached)


def _coupling(sources: Sequence[Source], places: int, passed_on: bool) -> str:
    one = "one source" if len(sources) == 1 else f"one cause of {len(sources)} sources"
    direct = f"{one}, read at {places} place{'s' if places > 1 else ''}"
    return f"{direct}; outputs made of it" if passed_on else direct


def with_evidence(
    groups: Sequence[DependentGroup], audits: Iterable[tuple[str, DecisionRecord]]
) -> tuple[DependentGroup, ...]:
    """Return the groups with what `audits`, each with its name, show of them.

    An audit counts for a group where its fault acts on channels of that group and on no other. A
    tap counts as reached where receipts show a fault in force.
    """
    records = [
        (name, record, {f.channel for f in record.question.faults}) for name, record in audits
    ]

    def shown(group: DependentGroup) -> DependentGroup:
        channels = {channel for way in group.ways for channel, _ in way.taps}
        about = [(name, record) for name, record, acts in records if acts and acts <= channels]
        ways = [
            way.model_copy(
                update={
                    "evidence": tuple(
                        evidence
                        for audit in about
                        if (evidence := _evidence(way, *audit)) is not None
                    )
                }
            )
            for way in group.ways
        ]
        return group.model_copy(update={"ways": tuple(ways)})

    return tuple(map(shown, groups))


def _evidence(way: Way, run: str, record: DecisionRecord) -> Evidence | None:
    path = next((path for path in record.paths if path.name == way.path), None)
    if path is None:
        return None
    faulted = {(tap.channel, tap.consumer) for tap in (*path.faulted, *path.baseline_faulted)}
    effect = next((effect for effect in record.effects if effect.path == way.path), None)
    return Evidence(
        run=run,
        fault=record.question.fault,
        said=_decision(record, effect),
        difference="" if effect is None else with_interval(effect.success),
        detected=effect is not None and effect.detected,
        missed=tuple(tap for tap in way.taps if tap not in faulted),
    )


def _decision(record: DecisionRecord, effect: Effect | None) -> str:
    if effect is None:
        return "run, no pair of trials left"
    aside = reservation(effect)
    if effect.sign == 0:
        return f"run, nothing significant{f' ({aside})' if aside else ''}"
    return f"{record.winner(effect.sign)} succeeds more often{f' ({aside})' if aside else ''}"
