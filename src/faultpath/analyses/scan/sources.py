"""Uncertain sources, who reads them in the variants scanned, and how large their errors are."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace

from pydantic import Field

from faultpath.core.errors import UserError
from faultpath.core.results import Frozen, Result
from faultpath.faults import FaultText, at_readers
from faultpath.interface import Interface, Provenance, Source, module_of
from faultpath.system.declared import Variant
from faultpath.system.system import System

_UNCERTAIN = (Provenance.MEASURED, Provenance.ESTIMATED, Provenance.RECONSTRUCTED)


class Candidate(Frozen, allow_inf_nan=False):
    """A source that may err, or several that err together by one cause."""

    name: str
    """Name of the source, or of the group whose sources err together."""
    sources: tuple[str, ...]
    channels: tuple[str, ...]
    readers: tuple[str, ...]
    """Places that read it in one of the variants: every use of a shared source counts."""
    fault: str = ""
    """As large as its expected error; empty where that is not known."""
    at: Mapping[str, str] = Field(default_factory=dict[str, str])
    """Faults of another size, by the module that gets them."""
    unsized: str = ""
    """Why there is no fault."""
    note: str = ""
    response: float | None = None
    """How far a probe moves the commands, see `ranking`: the largest of all variants, modules alone
    and all of them. Errors of several modules may cancel, and that is no reason to rank their
    source last."""
    rank: int | None = None
    """Sources that nothing tells apart share one; `None` before they are ranked."""

    @property
    def modules(self) -> tuple[str, ...]:
        """The modules that read it."""
        return tuple(dict.fromkeys(map(module_of, self.readers)))


class Ranking(Result):
    """The sources of a system that may err, the first to look at in front."""

    system: str
    variants: tuple[str, ...]
    sources: tuple[Candidate, ...]
    probed: int
    """Scenes of the probe; 0 where there was none."""


def candidates(
    system: System, variants: Sequence[Variant], faults: Sequence[FaultText]
) -> tuple[Candidate, ...]:
    """Return the uncertain sources that a variant reads, in the order of declaration.

    Uncertain is what is measured, estimated or reconstructed, or declares an uncertainty. The
    `faults` take the place of declared sizes, where they name readers at these alone. `UserError`
    for one that reaches no reader, and for two at one of them.
    """
    interface = system.interface
    members: dict[str, list[Source]] = {}  # by the group that errs together, or the source
    for source in interface.sources:
        uncertain = source.provenance in _UNCERTAIN or source.uncertainty
        if uncertain and channels_of(interface, variants, source.name):
            members.setdefault(source.correlation_group or source.name, []).append(source)
    listed: list[Candidate] = []
    for name, sources in members.items():
        every = [c for source in sources for c in channels_of(interface, variants, source.name)]
        channels = tuple(dict.fromkeys(every))
        fault, unsized = expected(system.fault_presets, name, sources, channels)
        names = tuple(source.name for source in sources)
        listed.append(_candidate(system, variants, name, names, channels, fault, unsized))
    texts = {str(fault) for fault in faults}
    for fault in faults:
        if fault.readers:
            continue
        candidate = _given(system, variants, fault)
        replaced = [other for other in listed if set(other.channels) <= set(candidate.channels)]
        if any(other.fault in texts for other in replaced):
            raise UserError(f"fault '{fault}': {replaced[0].name} has been given an error already.")
        if len(replaced) == 1:
            candidate = candidate.model_copy(update={"name": replaced[0].name})
        at = listed.index(replaced[0]) if replaced else len(listed)
        listed.insert(at, candidate)
        listed = [other for other in listed if other not in replaced]
    for fault in faults:
        if fault.readers:
            _size_at_readers(system, variants, fault, listed)
    return tuple(listed)


def _size_at_readers(
    system: System, variants: Sequence[Variant], fault: FaultText, listed: list[Candidate]
) -> None:
    """Give the modules that a fault names its size, in the list of sources."""
    narrowed = _given(system, variants, fault)
    if len(narrowed.modules) > 1:
        raise UserError(
            f"fault '{fault}': a scan runs the error of each reader alone: name one behind '@', or "
            "leave '@' out for all of them."
        )
    channels = set(narrowed.channels)
    place = next((i for i, other in enumerate(listed) if channels <= set(other.channels)), None)
    if place is None:
        whole = _given(system, variants, replace(fault, readers=()).at(fault.sizes[0]))
        unsized = f"has a size at {' and '.join(fault.readers)} alone"
        listed.append(whole.model_copy(update={"fault": "", "unsized": unsized}))
        place = len(listed) - 1
    candidate = listed[place]
    for module in narrowed.modules:
        if module in candidate.at:
            raise UserError(
                f"fault '{fault}': {candidate.name} at {module} has been given an error already."
            )
    at = {**candidate.at, **dict.fromkeys(narrowed.modules, str(fault))}
    listed[place] = candidate.model_copy(update={"at": at})


def bound(variant: Variant, interface: Interface, channel: str) -> str:
    """Return the source that feeds a channel in a variant."""
    return variant.bindings.get(channel, interface.channel(channel).sources[0])


def channels_of(interface: Interface, variants: Sequence[Variant], source: str) -> tuple[str, ...]:
    """Return the channels that a source feeds in one of the variants, where one reads them."""
    fed = {
        channel.name: None
        for variant in variants
        for channel in interface.channels
        if bound(variant, interface, channel.name) == source
        and variant.readers.intersection(channel.readers)
    }
    return tuple(fed)


def _given(system: System, variants: Sequence[Variant], fault: FaultText) -> Candidate:
    if fault.joined or (fault.kind not in (None, "scale", "offset")):
        raise UserError(
            f"fault '{fault}': a scan takes errors of one source that have two signs: "
            "SOURCE:scale=1.2, SOURCE:offset=0.1, or a preset of the system with its size."
        )
    if len(fault.sizes) != 1:
        raise UserError(f"fault '{fault}': a scan needs one size, which it runs with both signs.")
    channels = tuple(dict.fromkeys(part.channel for part in system.fault(fault)))
    sources = {bound(variant, system.interface, c): None for variant in variants for c in channels}
    candidate = _candidate(system, variants, fault.name, tuple(sources), channels, str(fault))
    if not candidate.readers:
        raise UserError(f"fault '{fault}' reaches no module: no version reads it there.")
    return candidate


def _candidate(
    system: System,
    variants: Sequence[Variant],
    name: str,
    sources: tuple[str, ...],
    channels: tuple[str, ...],
    fault: str,
    unsized: str = "",
) -> Candidate:
    interface, note = system.interface, ""
    if fault:
        parts = system.fault(fault)
        reached = [
            reader
            for variant in variants
            for part in at_readers(parts, variant.readers)
            for reader in part.readers
        ]
    else:
        read = [c for channel in channels for c in interface.channel(channel).readers]
        reached = [c for c in read if any(c in variant.readers for variant in variants)]
    for channel in channels:
        fed = [bound(variant, interface, channel) for variant in variants]
        if len(set(fed)) > 1:
            note = (
                f"Channel '{channel}' is fed by {fed[0]} in {variants[0].name} and by {fed[1]} in "
                f"{variants[1].name}, so a fault on it alters another source in each."
            )
            break
    return Candidate(
        name=name,
        sources=sources,
        channels=channels,
        readers=tuple(dict.fromkeys(reached)),
        fault=fault,
        unsized=unsized,
        note=note,
    )


def expected(
    presets: Collection[str], name: str, sources: Sequence[Source], channels: Sequence[str]
) -> tuple[str, str]:
    """Return a fault as large as the uncertainty declared, or why there is none.

    That is the half-range, or one standard deviation, upward, and lasting.
    """
    together = sources[0].correlation_group is not None
    declared = [source.uncertainty for source in sources if source.uncertainty is not None]
    if len(declared) < len(sources):
        return "", "declares no uncertainty"
    sizes = {
        (uncertainty.relative, uncertainty.half_range or uncertainty.std or 0.0)
        for uncertainty in declared
    }
    if len(sizes) > 1:
        return "", "has sources of different uncertainties, which one fault cannot have"
    if len(channels) > 1 and not together:
        feeds = " and ".join(channels)
        return "", f"feeds {feeds}, which one fault reaches only with a correlation_group"
    ((relative, size),) = sizes
    if size == 0.0:
        return "", "declares that it has no error"
    if together and relative and name in presets:
        return f"{name}=+{size:g}", ""
    target = name if together else channels[0]
    return (f"{target}:scale={1.0 + size:g}" if relative else f"{target}:offset={size:g}"), ""
