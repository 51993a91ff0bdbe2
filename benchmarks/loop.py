"""Closed-loop replans against the rollout alone, what their time goes into, and one vehicle's."""

import statistics
from collections.abc import Iterator

from benchmarks.comparison import Comparison, Outcome, absolute, at_most, judged, unmeasured
from benchmarks.flights import PARTS
from benchmarks.measure import NotMeasured, Running, Work
from benchmarks.results import Record

CHUNK = 13
ROUNDS = 5
REPLANS = 1000
SOURCES = {"true": "ground-truth clearance", "depth": "learned clearance"}
APART = ("rendering", "encoding")
"""Parts that the bound does not count: the camera and what reads its image, once a replan."""


def closed_loop() -> Outcome:
    """Fly a block with each source of clearance, in turn with the rollout alone."""
    records: list[Record] = []
    for source, words in SOURCES.items():
        try:
            records += _loop(source, words)
        except NotMeasured as reason:
            records.append(unmeasured("closed-loop", f"Closed loop, {words}", str(reason)))
    return Outcome(records)


def _loop(source: str, words: str) -> Iterator[Record]:
    flights = Work("benchmarks.flights:ClosedLoop", {"clearance": source})
    rollout = Work("benchmarks.planner:Rollout", {"scenes": CHUNK})
    with Running(flights) as flight, Running(rollout) as alone:
        *parts, whole = flight.answer()
        shares = {part: seconds / whole for part, seconds in zip(PARTS, parts, strict=True)}
        counted = 1 - sum(shares[part] for part in APART)
        times = [(1e3 * counted / flight.rate(), 1e3 / alone.rate()) for _ in range(ROUNDS)]
    ratios = [ours / peer for ours, peer in times]
    milliseconds = statistics.median(ours for ours, _ in times) / counted
    yield judged(
        Record(
            name=f"Closed loop, {words}",
            comparison="closed-loop",
            unit="ms",
            ours=counted * milliseconds,
            ours_name="control step of a scene",
            peer=statistics.median(peer for _, peer in times),
            peer_name="its rollout alone",
            ratio=statistics.median(ratios),
            low=min(ratios),
            high=max(ratios),
            target=at_most(1.35),
            note="" if source == "true" else "Rendering and encoding of the image are not counted.",
        )
    )
    shares["taps and everything else"] = 1 - sum(shares.values())
    for part, share in shares.items():
        if share > 0:
            yield absolute("closed-loop", f"{words}: {part}", [share * milliseconds], "ms")


def latency() -> Outcome:
    """Time a thousand replans of one vehicle, each by itself."""
    records: list[Record] = []
    for source, words in (
        ("field", "distance field"),
        ("depth", "depth image encoded and queried"),
    ):
        try:
            with Running(Work("benchmarks.latency:Latency", {"clearance": source})) as side:
                side.seconds(50)
                taken = sorted(1e3 * value for value in side.seconds(REPLANS, "wall"))
        except NotMeasured as reason:
            records.append(unmeasured("latency", f"One vehicle, {words}", str(reason)))
            continue
        for words_of, rank in (("median", 0.5), ("99th percentile", 0.99)):
            value = taken[min(int(rank * len(taken)), len(taken) - 1)]
            name = f"One vehicle, {words}: {words_of}"
            records.append(absolute("latency", name, [value], "ms", at_most(5.0, "ours")))
    return Outcome(records)


COMPARISONS = (Comparison("closed-loop", closed_loop), Comparison("latency", latency))
