"""Every kind of fault does in a fit what it does in a flight; images and several modules too."""

import numpy as np
import pytest

from faultpath.errors import UserError
from faultpath.faults import (
    INTERVENTIONS,
    Bias,
    Blur,
    Delay,
    Drift,
    Dropout,
    Erase,
    Exposure,
    Fault,
    Freeze,
    Hold,
    Intermittence,
    Intervention,
    Jitter,
    Noise,
    Occlusion,
    Offset,
    Quantise,
    Replace,
    SaltAndPepper,
    Scale,
    Sequence,
    Shuffle,
    Skew,
    StuckRows,
    UniformScale,
)
from faultpath.interface import read_interface
from faultpath.repairs.windows import Windows, delivered
from faultpath.taps import Reading, Taps

WINDOWS, STEPS, DT_S = 5, 8, 0.05
INTERFACE = read_interface("""
name: rover
sources:
- {name: camera, unit: '1', shape: [6, 8], provenance: measured}
channels:
- {name: image, sources: [camera], consumers: [encoder.pixels, guard.pixels], erasure_default: 0.5}
""")
KINDS: tuple[Intervention, ...] = (
    Scale(factor=1.1),
    UniformScale(half_range=0.2),
    Offset(by=0.1),
    Quantise(step_size=0.25),
    Erase(),
    Noise(std=0.3),
    Drift(walk_per_sqrt_s=0.5),
    Bias(std=0.3, time_constant_s=0.2),
    Delay(steps=3),
    Hold(every=3),
    Freeze(),
    Dropout(probability=0.4),
    Jitter(steps=3),
    Skew(rate=0.4),
    Occlusion(share=0.25),
    SaltAndPepper(probability=0.3),
    Blur(radius=1),
    Exposure(factor=3.0),
    StuckRows(share=0.5),
    Replace(value=2.0),
    Shuffle(axis=1),
    Sequence(parts=(Scale(factor=1.1), Noise(std=0.1))),
)
COMES_AND_GOES = Intermittence(mean_on_s=0.2, mean_off_s=0.1)


def test_no_kind_is_missing() -> None:
    assert {each.kind for each in KINDS} == set(INTERVENTIONS)  # pyright: ignore[reportAttributeAccessIssue]


@pytest.mark.parametrize("kind", KINDS, ids=lambda each: each.kind)
def test_a_window_gets_what_a_flight_of_its_name_and_seed_gets(kind: Intervention) -> None:
    images = np.random.default_rng(0).uniform(size=(WINDOWS, STEPS, 6, 8)).astype(np.float32)
    data = Windows(INTERFACE, "encoder", {"image": images}, targets=np.zeros(WINDOWS), dt_s=DT_S)
    for fault in (
        Fault(channel="image", intervention=kind, onset_step=1),
        Fault(channel="image", intervention=kind, intermittence=COMES_AND_GOES),
    ):
        got, counts = delivered(data, (fault,), data.readings, range(WINDOWS), 0, epoch=2)
        (seen,) = got.values()
        taps = Taps(INTERFACE, (fault,), scenes=data.ids, dt_s=DT_S, seed=2)
        flown = [
            taps.deliver("image", "encoder.pixels", Reading(images[:, step], "camera", step), step)
            for step in range(STEPS)
        ]
        np.testing.assert_array_equal(seen, np.stack(flown, axis=1))
        assert sum(count.altered_steps for count in counts)


def test_two_faults_that_would_draw_the_same_own_numbers_are_refused() -> None:
    faults = [
        Fault(channel="image", intervention=Bias(std=0.1), consumers=(module,), loading=0.5)
        for module in ("encoder", "guard")
    ]
    with pytest.raises(UserError, match=r"at encoder.* at guard.*: give each an `own_cause`"):
        Taps(INTERFACE, faults, scenes=("one",), dt_s=DT_S, seed=0)
    apart = [fault.model_copy(update={"own_cause": str(fault.consumers)}) for fault in faults]
    Taps(INTERFACE, apart, scenes=("one",), dt_s=DT_S, seed=0)


def test_errors_of_one_channel_at_two_modules_have_the_correlation_of_their_loadings() -> None:
    scenes = tuple(f"scene-{i}" for i in range(300))
    faults = [
        Fault(
            channel="image",
            intervention=Bias(std=0.1),
            consumers=(module,),
            cause="lens",
            loading=0.5**0.5,
            own_cause=f"lens/{module}",
        )
        for module in ("encoder", "guard")
    ]
    taps = Taps(INTERFACE, faults, scenes=scenes, dt_s=DT_S, seed=0)
    reading = Reading(np.zeros((len(scenes), 6, 8)), "camera", 0)
    errors = [
        taps.deliver("image", f"{module}.pixels", reading, 0).ravel()
        for module in ("encoder", "guard")
    ]
    assert np.corrcoef(errors)[0, 1] == pytest.approx(0.5, abs=0.03)
