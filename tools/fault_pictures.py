"""Every kind of fault: a picture of what it does to a signal, made by the taps themselves."""

import re
from collections.abc import Mapping
from itertools import groupby
from pathlib import Path

import numpy as np
from blocks import ROOT, Wrong
from numpy.typing import NDArray

from faultpath.faults import INTERVENTIONS, Delay, Fault, Quantise, Sequence, parse_fault
from faultpath.interface import read_interface
from faultpath.report.scale import Axis
from faultpath.report.svg import Svg
from faultpath.taps import Reading, Taps

Numbers = NDArray[np.float64]

STEPS, ONSET, DT_S = 60, 15, 0.05
SCENE = "faults/000"
WIDTH, HEIGHT, PAD = 240.0, 84.0, 6.0

INTERFACE = read_interface("""
name: pictures
sources:
- {name: sensor, unit: m, provenance: measured}
- {name: camera, unit: '1', provenance: measured, shape: [12, 18]}
- {name: window, unit: m, provenance: measured, shape: [24]}
channels:
- {name: speed, sources: [sensor], consumers: [filter.input]}
- {name: image, sources: [camera], consumers: [filter.look]}
- {name: history, sources: [window], consumers: [filter.past]}
""")


SHOWN: Mapping[str, str | Fault] = {
    "scale": "speed:scale=1.4",
    "uniform_scale": "speed:uniform_scale=0.5",
    "offset": "speed:offset=0.6",
    "quantise": "speed:quantise=0.5",
    "erase": "speed:erase=0",
    "noise": "speed:noise=0.2",
    "drift": "speed:drift=0.5",
    "bias": "speed:bias=0.4,time_constant_s=0.5",
    "delay": "speed:delay=8",
    "hold": "speed:hold=6",
    "freeze": "speed:freeze,for=25",
    "dropout": "speed:dropout=0.6",
    "jitter": "speed:jitter=8",
    "skew": "speed:skew=0.4",
    "occlusion": "image:occlusion=0.2",
    "salt_and_pepper": "image:salt_and_pepper=0.2",
    "blur": "image:blur=2",
    "exposure": "image:exposure=1.6",
    "stuck_rows": "image:stuck_rows=0.4",
    "replace": "speed:replace=0.5",
    "shuffle": "history:shuffle",
    "sequence": Fault(
        channel="speed", intervention=Sequence(parts=(Quantise(step_size=0.5), Delay(steps=6)))
    ),
}
"""An example a kind, as text where text can state it."""


def made(kind: str) -> Fault:
    """Return the fault that is shown of a kind, from the onset on."""
    if kind not in SHOWN:
        raise Wrong(f"tools/fault_pictures.py shows no fault of kind '{kind}': add one to SHOWN")
    shown = SHOWN[kind]
    fault = parse_fault(shown, INTERFACE, {}, DT_S) if isinstance(shown, str) else shown
    assert isinstance(fault, Fault)
    return fault.model_copy(update={"onset_step": ONSET})


def truth(channel: str, step: int) -> Numbers:
    """Return what the sensor says at a step, `[1, ...]`: no scene but one is drawn."""
    if channel == "image":
        down, across = np.mgrid[0:12, 0:18]
        middle = 4 + 10 * step / STEPS
        return (np.hypot(down - 6, across - middle) < 3.6).astype(float)[None] * 0.6 + 0.2
    steps = np.arange(step - 23, step + 1) if channel == "history" else np.array([step])
    value = np.sin(2 * np.pi * steps * DT_S / 1.5) + 0.35 * np.sin(2 * np.pi * steps * DT_S / 0.55)
    return value[None] if channel == "history" else value


def delivered(fault: Fault) -> tuple[list[Numbers], list[Numbers]]:
    """Return what the sensor says and what its consumer gets, step by step."""
    (consumer,) = INTERFACE.channel(fault.channel).consumers
    (source,) = INTERFACE.channel(fault.channel).sources
    taps = Taps(INTERFACE, [fault], scenes=(SCENE,), dt_s=DT_S)
    said = [truth(fault.channel, step) for step in range(STEPS)]
    got = [
        np.array(taps.deliver(fault.channel, consumer, Reading(value, source, step), step))
        for step, value in enumerate(said)
    ]
    return [each[0] for each in said], [each[0] for each in got]


def picture(kind: str) -> str:
    """Return what a kind of fault does, as SVG for light and dark."""
    fault = made(kind)
    said, got = delivered(fault)
    svg = Svg(WIDTH, HEIGHT, f"{kind}: {fault.intervention.words()}")
    if fault.channel == "image":
        for image, left in ((said[-1], 0.0), (got[-1], WIDTH / 2 + PAD)):
            _image(svg, image, left)
    elif fault.channel == "history":
        _signal(svg, list(said[-1]), list(got[-1]), None)
    else:
        _signal(svg, [float(each) for each in said], [float(each) for each in got], ONSET)
    return svg.render(standalone=True)


def _signal(svg: Svg, said: list[float], got: list[float], onset: int | None) -> None:
    low, high = min(*said, *got), max(*said, *got)
    across = Axis(0, len(said) - 1, 0, WIDTH)
    up = Axis(low, high, HEIGHT - PAD, PAD)
    if onset is not None:
        svg.line((across(onset), 0), (across(onset), HEIGHT), "band-edge")
    svg.line((0, up(0)), (WIDTH, up(0)), "axis")
    for values, first, style in (
        (said, 0, "stroke:var(--soft);stroke-width:1.25"),
        (got, onset or 0, "stroke:var(--struck)"),
    ):
        points = [f"{across(i):.1f},{up(y):.1f}" for i, y in enumerate(values) if i >= first]
        svg.path("M" + " L".join(points), "curve", style=style)


def _image(svg: Svg, image: Numbers, left: float) -> None:
    """Draw an image in grey, equal neighbours of a row as one rectangle."""
    side = round(WIDTH / 2 - PAD) // image.shape[1]  # whole pixels leave no seams
    for i, row in enumerate(image):
        column = 0
        for value, run in groupby(row):
            width, grey = len(list(run)), round(255 * min(max(value, 0.0), 1.0))
            svg.filled(
                left + column * side,
                i * side,
                width * side,
                side,
                f"rgb({grey},{grey},{grey})",
            )
            column += width


def pictures() -> Mapping[Path, str]:
    """Return the pictures of all kinds, by their path."""
    folder = ROOT / "docs" / "images"
    return {folder / name(kind): picture(kind) for kind in INTERVENTIONS}


def name(kind: str) -> str:
    """Return the file of a kind's picture."""
    return f"fault-{kind.replace('_', '-')}.svg"


def table(*kinds: str) -> str:
    """Return a row a kind: its picture, an example of it, and what it does."""
    unknown = set(kinds) - set(INTERVENTIONS)
    if unknown:
        raise Wrong(f"there is no kind {', '.join(sorted(unknown))} of fault")
    rows = ["| what it does to a signal | example | in words |", "|---|---|---|"]
    for kind in kinds:
        words = re.split(r"\n\s*\n", (INTERVENTIONS[kind].__doc__ or "").strip())[0]
        shown = SHOWN[kind]
        cells = (
            f"![{kind}]({{images}}/{name(kind)})",
            f"`{shown}`" if isinstance(shown, str) else f"`{kind}`, from Python",
            " ".join(words.split()),
        )
        rows.append(f"| {' | '.join(cells)} |")
    return "\n".join(rows)


KIND = {"table": table}
