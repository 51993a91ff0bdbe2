"""Plant, camera and statistics against other software that does the same."""

from benchmarks.comparison import Comparison, Outcome, Writer, at_least, at_most
from benchmarks.measure import Work, interleaved

STEPS = "vehicle-steps/s"
PORTABLE = {"FAULTPATH_KERNELS": "portable"}


def plant() -> Outcome:
    """Compare the full plant at 100 vehicles."""
    rates = interleaved(
        {
            "faultpath": Work("benchmarks.physics:FullPlant"),
            "faultpath, portable": Work("benchmarks.physics:FullPlant", environment=PORTABLE),
            "RotorPy": Work("benchmarks.peers.rotorpy_side:Hummingbirds"),
            "MuJoCo, rate loop in Python": Work(
                "benchmarks.peers.mujoco_side:Steps", {"control": "python"}
            ),
            "MuJoCo, no rate loop": Work("benchmarks.peers.mujoco_side:Steps"),
        },
        same={"faultpath": "faultpath, portable"},
        tolerance=1e-9,
    )
    writer = Writer("plant", rates)
    floor = at_least(150_000, "ours")
    records = [
        writer.versus(f"Full plant, {peer}", "faultpath", peer, STEPS, floor if first else None)
        for first, peer in (
            (True, "RotorPy"),
            (False, "MuJoCo, rate loop in Python"),
            (False, "MuJoCo, no rate loop"),
        )
    ]
    return Outcome(
        [
            *records,
            writer.versus("Portable plant, RotorPy", "faultpath, portable", "RotorPy", STEPS),
        ]
    )


def depth() -> Outcome:
    """Compare depth images of a block of scenes with MuJoCo's rays."""
    rates = interleaved(
        {
            "faultpath": Work("benchmarks.physics:Rendering"),
            "mj_multiRay": Work("benchmarks.peers.mujoco_side:Rays"),
        },
        same={"mj_multiRay": "faultpath"},
        tolerance=0.02,
    )
    writer = Writer("depth", rates)
    return Outcome(
        [
            writer.versus(
                "Depth image 64 x 36", "faultpath", "mj_multiRay", "images/s", at_least(1.0)
            )
        ]
    )


def bootstrap() -> Outcome:
    """Compare a bootstrap interval with SciPy's, and without the draw of the resamples."""
    where = "benchmarks.statistics_side"
    rates = interleaved(
        {
            "faultpath": Work(f"{where}:Ours"),
            "faultpath, resamples drawn": Work(f"{where}:Ours", {"drawn": True}),
            "scipy.stats.bootstrap": Work(f"{where}:Scipy"),
        },
        same={"scipy.stats.bootstrap": "faultpath"},
        tolerance=1.0,
    )
    writer = Writer("bootstrap", rates)
    limit = at_most(20.0, "ours")
    return Outcome(
        [
            writer.versus(name, ours, "scipy.stats.bootstrap", "ms", limit)
            for name, ours in (
                ("Bootstrap with its draw", "faultpath"),
                ("Bootstrap on drawn resamples", "faultpath, resamples drawn"),
            )
        ]
    )


COMPARISONS = (
    Comparison("plant", plant),
    Comparison("depth", depth),
    Comparison("bootstrap", bootstrap),
)
