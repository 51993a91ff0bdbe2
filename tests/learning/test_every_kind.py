"""Every kind of fault does in a fit what it does in a flight; images and several modules too."""

import sys
from pathlib import Path

import numpy as np
import pytest

from faultpath import faults
from faultpath.interface import read_interface
from faultpath.learning.windows import Windows, delivered
from faultpath.loop import Reading, Taps

sys.path.append(str(Path(__file__).resolve().parents[1] / "loop"))
from tap_toys import INTERVENTIONS

WINDOWS, STEPS, DT_S = 5, 8, 0.05
OF_NO_IMAGE = {"rotate", "recorded"}
"""They turn vectors of three, and deliver the errors of trials that a file names."""
INTERFACE = read_interface("""
name: rover
sources:
- {name: camera, unit: '1', shape: [6, 8], provenance: measured}
channels:
- {name: image, sources: [camera], readers: [encoder.pixels, guard.pixels], erasure_default: 0.5}
""")
SHAPE = INTERFACE.source("camera").shape
KINDS = tuple(kind for kind in INTERVENTIONS if kind.misfit(SHAPE) is None)


def test_no_kind_is_missing() -> None:
    # Every kind of fault declares it; the union's base does not.
    assert {each.kind for each in KINDS} | OF_NO_IMAGE == set(faults.INTERVENTIONS)  # pyright: ignore[reportAttributeAccessIssue]


@pytest.mark.parametrize("kind", KINDS, ids=lambda each: each.kind)
def test_a_window_gets_what_a_flight_of_its_name_and_seed_gets(kind: faults.Intervention) -> None:
    images = np.random.default_rng(0).uniform(size=(WINDOWS, STEPS, 6, 8)).astype(np.float32)
    data = Windows(INTERFACE, "encoder", {"image": images}, targets=np.zeros(WINDOWS), dt_s=DT_S)
    everywhere = faults.Fault(channel="image", intervention=kind, onset_step=1)
    (fault,) = faults.resolve((everywhere,), INTERFACE, {"encoder.pixels"})
    got, counts = delivered(data, (fault,), data.readings, range(WINDOWS), 0, epoch=2)
    (seen,) = got.values()
    taps = Taps(INTERFACE, (fault,), scenes=data.ids, dt_s=DT_S, seed=2)
    readings = [Reading(images[:, step], "camera", step) for step in range(STEPS)]
    flown = [taps.deliver("image", "encoder.pixels", r, i) for i, r in enumerate(readings)]
    np.testing.assert_array_equal(seen, np.stack(flown, axis=1))
    assert sum(count.altered_steps for count in counts)
