"""A scene of a run for the viewer of rerun: flights, obstacles and signals on one clock."""

from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

from faultpath.errors import UserError
from faultpath.report.inputs import ReportInput
from faultpath.report.pairing import by_scene, read_pairs
from faultpath.report.viewer_choice import track_of
from faultpath.store import TrialAddress
from faultpath.text import extra
from faultpath.trials import FloorPlan


def export(held: ReportInput, scene: str, seed: int | None, out: Path) -> None:
    """Write a scene as `.rrd`; `seed` by default the first.

    Entities are `path/arm/..`. Raises `UserError` where the seed was not flown, the file cannot be
    written, or rerun is missing.
    """
    try:
        rr: Any = import_module("rerun")
    except ModuleNotFoundError:
        raise UserError(f"an .rrd needs rerun, not installed here: {extra('rerun')}.") from None
    asked = held.record.question
    drawn = asked.seeds[0] if seed is None else seed
    pairs = by_scene(read_pairs(held.outcomes, held.record)).get((scene, drawn))
    if pairs is None:
        raise UserError(f"scene '{scene}' was not flown with seed {drawn}: choose {asked.seeds}.")
    stream = rr.RecordingStream("faultpath", recording_id=f"{scene}-{drawn}")
    try:
        stream.save(str(out))
    except OSError as error:
        raise UserError(f"cannot write {out} ({error}).") from error
    if scene in held.plans:
        stream.log("scene", rr.LineStrips3D(_rings(held.plans[scene])), static=True)
    for path, pair in pairs.items():
        for arm, variant in (("baseline", asked.baseline), ("repair", asked.repair)):
            track, at = track_of(held.traces, variant, pair), (path, arm)
            if len(track):
                still = rr.new_entity_path([*at, "track"])
                stream.log(still, rr.LineStrips3D([track]), static=True)
                moving, place = rr.Points3D.columns(positions=track), [*at, "vehicle"]
                stream.send_columns(
                    rr.new_entity_path(place), [_clock(rr, held, len(track))], moving
                )
            for signal in held.signals.get(TrialAddress(variant, path, drawn, scene), ()):
                for part, values in enumerate(signal.values.T):
                    called = signal.parts[part] if signal.parts else str(part)
                    name = rr.new_entity_path([*at, signal.topic, signal.name, called])
                    lines = rr.Scalars.columns(scalars=values)
                    stream.send_columns(name, [_clock(rr, held, len(values))], lines)
    stream.flush()


def _clock(rr: Any, held: ReportInput, steps: int) -> Any:
    return rr.TimeColumn("time", duration=np.arange(steps) * held.traces.dt_s)


def _rings(plan: FloorPlan) -> list[list[tuple[float, float, float]]]:
    turns = np.linspace(0.0, 2.0 * np.pi, 17)
    shapes = [(p.corners + p.corners[:1], p.bottom, p.top) for p in plan.prisms]
    for p in plan.pillars:
        round_ = [(p.x + p.radius * np.cos(a), p.y + p.radius * np.sin(a)) for a in turns]
        shapes.append((tuple(round_), p.bottom, p.top))
    return [[(x, y, z) for x, y in ring] for ring, low, high in shapes for z in (low, high)]
