"""The probe of a source: only what the modules make of the faulty input differs."""

import runpy
from pathlib import Path

import numpy as np
import pytest

from faultpath.analyses.scan.ranking import command_responses
from faultpath.faults import at_readers
from faultpath.loop import Batch, Taps

SYSTEM = runpy.run_path(str(Path(__file__).parents[2] / "examples" / "toy.py"))["create"]()
SCENES = tuple(f"cart/{i:03d}" for i in range(5))


def responses(variant: str, **texts: str) -> dict[str, float]:
    readers = SYSTEM.variants[variant].readers
    variants = {(name, ""): at_readers(SYSTEM.fault(text), readers) for name, text in texts.items()}
    found = command_responses(SYSTEM, variant, variants, SCENES, 0)
    return {name: value for (name, _), value in found.items()}


def flight(variant: str) -> tuple[np.ndarray, np.ndarray]:
    """Return commands and gains under correct inputs, `[T, B]` and `[B]`."""
    taps = Taps(SYSTEM.interface, scenes=SCENES, dt_s=0.1, readers=SYSTEM.variants[variant].readers)
    loop = SYSTEM.loop(variant, 0)
    commands, gain = [], None
    for instant in loop.execute(Batch(SCENES, 0, 0.1), taps):
        if len(instant.inputs):
            commands.append(np.array(instant.inputs["push", "motor"]))
            gain = instant.state.gain
    return np.stack(commands), gain


def median(moved: np.ndarray, commands: np.ndarray) -> float:
    return float(np.median(np.abs(moved)) / np.sqrt(np.mean(commands**2)))


def test_the_controller_alone_divides_by_the_error():
    commands, _ = flight("blind")
    moved = responses("blind", gain="gain:scale=1.25@controller")
    assert moved["gain"] == pytest.approx(median(commands * (1 / 1.25 - 1), commands), rel=1e-5)


def test_the_observer_alone_works_on_the_commands_of_the_flight_and_remembers():
    commands, gain = flight("calibrated")
    slope = np.zeros_like(gain)
    moved = [slope]
    for executed in commands[:-1]:  # an observer that believes another gain, on the same history
        slope = 0.5 * slope - 0.5 * 0.25 * gain * executed
        moved.append(slope)
    found = responses("calibrated", gain="gain:scale=1.25@observer")
    assert found["gain"] == pytest.approx(median(np.stack(moved) / gain, commands), rel=1e-5)


def test_probing_leaves_no_trace_and_errors_that_cancel_are_small():
    before, _ = flight("calibrated")
    one = responses("calibrated", gain="gain:scale=1.25", velocity="velocity:offset=0.1")
    two = responses("calibrated", velocity="velocity:offset=0.1", gain="gain:scale=1.25")
    assert one == two
    assert one["gain"] < 0.1 * responses("calibrated", gain="gain:scale=1.25@observer")["gain"]
    after, _ = flight("calibrated")
    np.testing.assert_array_equal(before, after)
