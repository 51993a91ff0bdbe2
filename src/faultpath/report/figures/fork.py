"""One path of a fault as a picture: the source splits to its modules, in either arm."""

from collections.abc import Sequence

from faultpath.report.story import Arm, Fork, Reader
from faultpath.report.svg import Svg, shortened

_WIDTH, _ARM, _EDGE = 308.0, 147.0, 1.0
_PITCH, _MODULES = 46.0, 102.0
_TRUNK, _TAP, _BOX = 12.0, 27.0, 38.0


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
