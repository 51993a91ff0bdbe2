"""What the first screen tells beside the numbers: what the fault does, and to whom on each path.

Which taps were struck comes from receipts, who reads from the wiring of the variants, and what may
be said from the record.
"""

from collections.abc import Sequence
from dataclasses import dataclass

from faultpath.interface import module_of
from faultpath.record import CORRECT, SHARED
from faultpath.record.fault_words import fault_words, spelled_out
from faultpath.record.model import Path, StruckTap
from faultpath.record.wording import capital, series
from faultpath.report.inputs import ReportInput
from faultpath.report.svg import Svg, shortened
from faultpath.report.taps import Tap
from faultpath.trials import VariantShown

_WIDTH, _ARM, _EDGE = 308.0, 147.0, 1.0
_PITCH, _MODULES = 46.0, 102.0
_TRUNK, _TAP, _BOX = 12.0, 27.0, 38.0
_SHORT = 9
"""Letters of a channel's name that still fit into the box of a module."""


@dataclass(frozen=True)
class Reader:
    """A module that may read what the fault strikes, in one arm."""

    module: str
    taps: frozenset[Tap]
    """At which its variant reads it; empty where it does not."""
    struck: frozenset[Tap]
    """Of these, where receipts show the fault in force."""
    changed: bool
    """Whether the fault changed a reading at one of them."""

    @property
    def state(self) -> str:
        """Say what reaches the module."""
        names = {channel for channel, _ in self.taps}
        what = "readings" if len(names) > 1 else "reading"
        if len(names) == 1 and len(min(names)) <= _SHORT:
            what = _named(min(names))
        if not self.taps:
            return "does not read it"
        if not self.struck:
            return f"correct {what}"
        if not self.changed:
            return "gets it unchanged"
        return f"wrong {what}" if self.struck == self.taps else "partly wrong"


@dataclass(frozen=True)
class Arm:
    """One variant on one path."""

    role: str
    """`baseline` or `repair`."""
    name: str
    readers: tuple[Reader, ...]


@dataclass(frozen=True)
class Fork:
    """One path of the fault: a source, and the modules that it splits to."""

    title: str
    channels: tuple[str, ...]
    everywhere: bool
    """Whether the fault was at every tap at which either variant reads, as from a faulty source."""
    arms: tuple[Arm, ...]

    @property
    def told(self) -> str:
        """Say all that the picture shows."""
        return " ".join(
            f"{arm.role.capitalize()} {arm.name}: {series([_told(r) for r in arm.readers])}."
            for arm in self.arms
        )


def channels(source: ReportInput) -> tuple[str, ...]:
    """Return what the fault is put on: as it is spelled out, or else by the receipts."""
    record = source.record
    faults = spelled_out(record.question, source.interface, source.traces.dt_s)
    struck = (tap.channel for path in record.paths for tap in (*path.struck, *path.baseline_struck))
    return tuple(dict.fromkeys([fault.channel for fault in faults] or struck))


def forks(source: ReportInput) -> tuple[Fork, ...]:
    """Return every path of the fault, isolated ones first; none where no tap is known."""
    record, names = source.record, channels(source)
    reads = {variant.name: _reads(source, variant, names) for variant in source.variants}
    every = frozenset[Tap]().union(*reads.values())

    def fork(path: Path) -> Fork:
        hit = {(tap.channel, tap.consumer) for tap in (*path.struck, *path.baseline_struck)}
        return Fork(
            title=path.title,
            channels=names,
            everywhere=every <= hit,
            arms=_arms(source, path, reads, every),
        )

    faulty = [path for path in record.paths if path.name != CORRECT]
    return tuple(map(fork, faulty)) if every else ()


def isolation_words(source: ReportInput) -> dict[str, str]:
    """Say what isolated and shared mean in this system."""
    names = [path.name for path in source.record.paths]
    modules = [_named(name) for name in names if name not in (CORRECT, SHARED)]
    told = {"Isolated": f"The fault at one module alone: the {' or the '.join(modules)}."}
    reading = {
        module_of(consumer)
        for variant in source.variants
        for _, consumer in _reads(source, variant, channels(source))
    }
    spared = sorted(reading - set(names))
    if SHARED in names:
        told["Isolated"] += " All others get the correct reading."
        told["Shared"] = (
            f"The fault at {series([f'the {each}' for each in modules])} at once, as if their "
            "common source were wrong."
        )
    elif not spared:
        told["Isolated"] += " No other module reads it, so there is nothing to share."
    if spared:
        others = series([f"the {_named(each)}" for each in spared])
        reads = "reads it too and gets" if len(spared) == 1 else "read it too and get"
        told["Isolated"] += f" {capital(others)} {reads} the correct reading on every path."
    return told


def out_of_reach(source: ReportInput) -> tuple[str, ...]:
    """Say on which paths the fault cannot reach a variant, and what stands in."""
    said: list[str] = []
    asked = source.record.question
    for path in source.record.paths:
        for name, planned in (
            (asked.baseline, path.baseline_consumers),
            (asked.repair, path.consumers),
        ):
            if path.name not in (CORRECT, SHARED) and not planned:
                said.append(
                    f"The {_named(path.name)} of {name} reads nothing that the fault strikes: with "
                    f"only the {_named(path.name)} struck, the trials of {name} under correct "
                    "inputs stand in."
                )
    return tuple(said)


def fault_story(source: ReportInput) -> str:
    """Say what the fault does, in numbers and units."""
    asked = source.record.question
    said = fault_words(asked, source.interface, source.traces.dt_s)
    if said:
        return said
    names = [f"'{name}'" for name in channels(source)]
    strikes = f"; it strikes {series(names)}" if names else ""
    return f"A fault that the system names, of which this record does not say more{strikes}."


def _reads(source: ReportInput, variant: VariantShown, names: Sequence[str]) -> frozenset[Tap]:
    return frozenset(
        (name, consumer)
        for name in names
        for consumer in source.interface.channel(name).consumers
        if consumer in variant.consumers
    )


def _arms(
    source: ReportInput, path: Path, reads: dict[str, frozenset[Tap]], every: frozenset[Tap]
) -> tuple[Arm, ...]:
    asked = source.record.question
    modules = dict.fromkeys(sorted(module_of(consumer) for _, consumer in every))
    return tuple(
        Arm(
            role,
            name,
            tuple(_reader(module, reads[name], struck) for module in modules),
        )
        for role, name, struck in (
            ("baseline", asked.baseline, path.baseline_struck),
            ("repair", asked.repair, path.struck),
        )
    )


def _reader(module: str, reads: frozenset[Tap], struck: Sequence[StruckTap]) -> Reader:
    here = [tap for tap in struck if module_of(tap.consumer) == module]
    hit = frozenset((tap.channel, tap.consumer) for tap in here)
    # Receipts come before the wiring: a tap that was struck was read.
    taps = hit | frozenset(tap for tap in reads if module_of(tap[1]) == module)
    return Reader(module, taps, hit, any(tap.altered_steps for tap in here))


def _told(reader: Reader) -> str:
    places = ", ".join(f"{channel} at {consumer}" for channel, consumer in sorted(reader.struck))
    return f"{_named(reader.module)} {reader.state}{f' ({places})' if places else ''}"


def _named(module: str) -> str:
    return module.replace("_", " ")


def fork_panels(forks: Sequence[Fork]) -> list[str]:
    """Return a picture of each path."""
    return [_panel(fork) for fork in forks]


def _panel(fork: Fork) -> str:
    bottom = _MODULES + _PITCH * len(fork.arms[0].readers)
    svg = Svg(_WIDTH, bottom, f"{fork.title}: who gets the fault", fork.told)
    svg.text(0, 14, shortened(fork.title, _WIDTH, 13), "head", tip=fork.title)
    for x, arm in zip((_EDGE, _WIDTH - _ARM - _EDGE), fork.arms, strict=True):
        _arm(svg, x, arm, fork)
    return svg.render()


def _arm(svg: Svg, x: float, arm: Arm, fork: Fork) -> None:
    svg.text(x, 34, arm.role, "small soft")
    svg.text(x, 49, shortened(arm.name, _ARM, 12), f"bold {arm.role}", tip=arm.name)
    names = ", ".join(name.replace("_", " ") for name in fork.channels)
    wrong = " wrong" if fork.everywhere else ""
    svg.rect(x, 57, _ARM, 36, f"source{wrong}", 4)
    svg.text(x + 8, 72, shortened(names, _ARM - 16, 12), tip=names)
    state = "wrong for all" if fork.everywhere else "correct at the source"
    svg.text(x + 8, 87, state, f"small {'struck' if wrong else 'soft'}")
    for i, reader in enumerate(arm.readers):
        _branch(svg, x, _MODULES + _PITCH * (i + 0.5), reader, fork.everywhere)


def _branch(svg: Svg, x: float, y: float, reader: Reader, everywhere: bool) -> None:
    """Draw one module with its way from the source, and the tap on it."""
    above, cls = max(93.0, y - _PITCH), "wire hit" if reader.struck else "wire"
    if not reader.taps:
        svg.path(f"M{x + _TRUNK} {above}V{y}H{x + _BOX}", "wire other")
        svg.rect(x + _BOX, y - 19, _ARM - _BOX, 38, "absent", 4)
    else:
        trunk = "wire hit" if everywhere else "wire"
        svg.line((x + _TRUNK, above), (x + _TRUNK, y), trunk)
        svg.line((x + _TRUNK, y), (x + _TAP, y), trunk)
        svg.line((x + _TAP, y), (x + _BOX, y), cls)
        svg.rect(x + _BOX, y - 19, _ARM - _BOX, 38, "module", 4)
        svg.circle((x + _TAP, y), 6, "tap hit" if reader.struck else "tap")
        if reader.struck:
            svg.path(f"M{x + _TAP + 2} {y - 4}l-4 4.5h4l-4 4.5", "bolt")
    room = _ARM - _BOX - 12
    soft = "" if reader.taps else "soft"
    name = reader.module.replace("_", " ")
    svg.text(x + _BOX + 6, y - 3, shortened(name, room, 12), f"bold {soft}".strip(), tip=name)
    state = "small struck" if reader.struck else "small soft"
    svg.text(x + _BOX + 6, y + 12, shortened(reader.state, room, 11), state)
