"""Who gets the fault: a picture of each condition.

The delivery log says which taps had the fault in force, and the variants say who reads.
"""

from dataclasses import dataclass

from markupsafe import Markup

from faultpath.analyses.model import CORRECT
from faultpath.core.text import series
from faultpath.interface import module_of
from faultpath.report.inputs import ReportInput
from faultpath.report.sentences.wording import in_words
from faultpath.report.svg import Svg

Tap = tuple[str, str]
"""A channel and the reader that reads it."""

_WIDTH, _VARIANT, _EDGE = 308.0, 147.0, 1.0
_PITCH, _MODULES = 46.0, 102.0
_TRUNK, _TAP, _BOX = 12.0, 27.0, 38.0
_SHORT = 9
"""Letters of a channel's name that still fit into the box of a module."""


@dataclass(frozen=True)
class Reader:
    """A module that may read what the fault is on, in one variant."""

    module: str
    taps: frozenset[Tap]
    """At which its variant reads it; empty where it does not."""
    faulted: frozenset[Tap]
    """Taps at which the delivery log shows the fault in force."""
    changed: bool
    """Whether the fault changed a reading at one of them."""

    @property
    def state(self) -> str:
        """Say what reaches the module."""
        names = {channel for channel, _ in self.taps}
        what = "readings" if len(names) > 1 else "reading"
        if len(names) == 1 and len(min(names)) <= _SHORT:
            what = in_words(min(names))
        if not self.taps:
            return "does not read it"
        if not self.faulted:
            return f"correct {what}"
        if not self.changed:
            return "gets it unchanged"
        return f"wrong {what}" if self.faulted == self.taps else "partly wrong"


@dataclass(frozen=True)
class Fork:
    """One condition of the fault: a source, and the modules that it splits to."""

    title: str
    channels: tuple[str, ...]
    everywhere: bool
    """Whether the fault was at every tap at which either variant reads, as from a faulty source."""
    variants: tuple[tuple[str, str, tuple[Reader, ...]], ...]
    """Role and name of each variant, with its modules."""


def forks(source: ReportInput) -> tuple[Fork, ...]:
    """Return every condition of the fault, isolated ones first; none where no tap is known."""
    result, question = source.record, source.record.question
    faulted = (
        tap.channel
        for condition in result.conditions
        for tap in (*condition.faulted, *condition.baseline_faulted)
    )
    names = tuple(dict.fromkeys([fault.channel for fault in source.record.facts.faults] or faulted))
    reads = [
        frozenset(
            (name, reader)
            for name in names
            for reader in source.system.interface.channel(name).readers
            if reader in variant.readers
        )
        for variant in source.system.variants
    ]
    every = frozenset[Tap]().union(*reads)
    modules = sorted({module_of(reader) for _, reader in every})
    branches: list[Fork] = []
    for condition in result.conditions if every else ():
        if condition.name == CORRECT:
            continue
        variants: list[tuple[str, str, tuple[Reader, ...]]] = []
        untouched = every
        for role, name, taps, read in (
            ("baseline", question.baseline, condition.baseline_faulted, reads[0]),
            ("repair", question.repair, condition.faulted, reads[1]),
        ):
            hit = frozenset((tap.channel, tap.reader) for tap in taps)
            untouched -= hit
            readers: list[Reader] = []
            for module in modules:
                # The delivery log comes before the wiring: a faulted tap was read.
                here = frozenset(tap for tap in hit | read if module_of(tap[1]) == module)
                changed = any(t.altered_steps for t in taps if module_of(t.reader) == module)
                readers.append(Reader(module, here, here & hit, changed))
            variants.append((role, name, tuple(readers)))
        branches.append(Fork(condition.title, names, not untouched, tuple(variants)))
    return tuple(branches)


def fork_panel(fork: Fork) -> Markup:
    """Return the picture of a condition."""
    description = " ".join(
        f"{role.capitalize()} {name}: "
        + series([f"{in_words(reader.module)} {reader.state}" for reader in readers])
        + "."
        for role, name, readers in fork.variants
    )
    bottom = _MODULES + _PITCH * len(fork.variants[0][2])
    svg = Svg(_WIDTH, bottom, f"{fork.title}: who gets the fault", description)
    svg.text(0, 14, fork.title, "head", room=_WIDTH)
    names = ", ".join(map(in_words, fork.channels))
    wrong = " wrong" if fork.everywhere else ""
    state = "wrong for all" if fork.everywhere else "correct at the source"
    for x, (role, name, readers) in zip(
        (_EDGE, _WIDTH - _VARIANT - _EDGE), fork.variants, strict=True
    ):
        svg.text(x, 34, role, "small soft")
        svg.text(x, 49, name, f"bold {role}", room=_VARIANT)
        svg.rect(x, 57, _VARIANT, 36, f"source{wrong}", 4)
        svg.text(x + 8, 72, names, room=_VARIANT - 16)
        svg.text(x + 8, 87, state, f"small {'faulted' if wrong else 'soft'}")
        for i, reader in enumerate(readers):
            _branch(svg, x, _MODULES + _PITCH * (i + 0.5), reader, fork.everywhere)
    return svg.render()


def _branch(svg: Svg, x: float, y: float, reader: Reader, everywhere: bool) -> None:
    """Draw one module with its way from the source, and the tap on it."""
    above, box, room = max(93.0, y - _PITCH), x + _BOX, _VARIANT - _BOX - 9
    if not reader.taps:
        svg.path(f"M{x + _TRUNK} {above}V{y}H{box}", "wire other")
        svg.rect(box, y - 19, _VARIANT - _BOX, 38, "absent", 4)
    else:
        trunk, hit = "wire hit" if everywhere else "wire", " hit" if reader.faulted else ""
        svg.line((x + _TRUNK, above), (x + _TRUNK, y), trunk)
        svg.line((x + _TRUNK, y), (x + _TAP, y), trunk)
        svg.line((x + _TAP, y), (box, y), f"wire{hit}")
        svg.rect(box, y - 19, _VARIANT - _BOX, 38, "module", 4)
        svg.circle((x + _TAP, y), 6, f"tap{hit}")
        if hit:
            svg.path(f"M{x + _TAP + 2} {y - 4}l-4 4.5h4l-4 4.5", "bolt")
    cls = "bold" if reader.taps else "bold soft"
    svg.text(box + 6, y - 3, in_words(reader.module), cls, room=room)
    cls = "small faulted" if reader.faulted else "small soft"
    taps = sorted(reader.faulted or reader.taps)
    tip = f"{reader.state}: {', '.join(f'{channel} at {at}' for channel, at in taps)}"
    svg.text(box + 6, y + 12, reader.state, cls, tip=tip, room=room)
