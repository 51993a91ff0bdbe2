"""How the time of a rollout grows, and what a second worker brings."""

import statistics
import tempfile
from pathlib import Path

from benchmarks.commands import audit, workers_command
from benchmarks.comparison import Comparison, Outcome, absolute, at_least, at_most, growth, judged
from benchmarks.measure import Work, interleaved
from benchmarks.product import together
from benchmarks.results import Curve, Record

SIZES = {
    "candidates": (256, 512, 1024, 2048, 4096),
    "steps": (5, 10, 20, 40),
    "scenes": (1, 5, 25, 100),
}
ROUNDS = 5
PRODUCT_S = 4.0
LINEAR = 1.15
"""Most that a time may be above what size and the first point foretell, to count as linear."""


def rollout() -> Outcome:
    """Time the rollout of one scene over candidates and steps, and of several scenes."""
    records: list[Record] = []
    curves: list[Curve] = []
    for across, sizes in SIZES.items():
        side = "benchmarks.planner:Rollout"
        works = {str(size): Work(side, {across: size}) for size in sizes}
        rates = interleaved(works, rounds=ROUNDS)
        points = [
            (float(size), 1e3 * (size if across == "scenes" else 1) / statistics.median(values))
            for size, values in ((int(name), rates.rounds[name]) for name in rates.rounds)
        ]
        curve = Curve(
            name=f"Rollout over {across}",
            comparison="scaling",
            across=across,
            unit="ms",
            points=tuple(points),
        )
        curves.append(curve)
        records.append(growth(curve, "scaling", f"Rollout over {across}: linear", LINEAR))
    return Outcome(records, curves)


def workers() -> Outcome:
    """Run a small audit with one worker and with two, and watch its memory."""
    with tempfile.TemporaryDirectory() as folder:
        one, two = (audit(workers_command(n, Path(folder) / str(n))) for n in (1, 2))
    seconds = judged(
        Record(
            name="Small audit, two workers against one",
            comparison="workers",
            unit="s",
            ours=two.seconds,
            ours_name="two workers",
            peer=one.seconds,
            peer_name="one worker",
            ratio=one.seconds / two.seconds,
            target=at_least(1.8),
            note="Start-up and the report are in both.",
        )
    )
    memory = absolute(
        "workers",
        "Small audit, two workers: peak memory",
        [two.peak_bytes / 1e9],
        "GB",
        at_most(2.0, "ours"),
        "All processes together; what they share counts once.",
    )
    return Outcome([seconds, _ceiling(), memory])


def _ceiling() -> Record:
    """Return what a second process brings where nothing of ours runs."""
    rounds = [(together(1, PRODUCT_S), together(2, PRODUCT_S)) for _ in range(3)]
    ratios = [two / one for one, two in rounds]
    return Record(
        name="torch.mm alone, two processes against one",
        comparison="workers",
        unit="products/s",
        ours=statistics.median(two for _, two in rounds),
        ours_name="two processes",
        peer=statistics.median(one for one, _ in rounds),
        peer_name="one process",
        ratio=statistics.median(ratios),
        low=min(ratios),
        high=max(ratios),
        note="What this machine gives a second process that multiplies matrices and nothing else.",
    )


COMPARISONS = (Comparison("scaling", rollout), Comparison("workers", workers))
