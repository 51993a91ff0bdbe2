"""The closed loop against the rollout alone, one vehicle, and how a rollout's time grows."""

from collections.abc import Iterator, Mapping
from functools import partial
from statistics import median, quantiles

from benchmarks.comparison import Case, Effort, Found
from benchmarks.flights import PARTS, SCENES
from benchmarks.measure import Running, Work, interleaved
from benchmarks.results import Curve, Record, at_most, record

CHUNK = 13
ROUNDS = 5
REPLANS = 1000
APART = ("rendering", "encoding")
"""Parts that the bound does not count: the camera and what reads its image, once a replan."""
SIZES = {
    "candidates": (256, 512, 1024, 2048, 4096),
    "steps": (5, 10, 20, 40),
    "scenes": (1, 5, 25, 100),
}
LINEAR = 1.15
"""Most that a time may be above what size and the first point foretell, to count as linear."""


def _closed(source: str, words: str, effort: Effort) -> Iterator[Record]:
    """Fly a block with a source of clearance, in turn with the rollout alone."""
    given = {"clearance": source, "scenes": effort.of(SCENES), "repeats": effort.of(3)}
    flights = Work("benchmarks.flights:ClosedLoop", given)
    rollout = Work("benchmarks.planning:rollout", {"scenes": CHUNK})
    with Running(flights) as flight, Running(rollout) as alone:
        *parts, whole = flight.answer()
        shares = {part: seconds / whole for part, seconds in zip(PARTS, parts, strict=True)}
        counted = 1 - sum(shares[part] for part in APART)
        rounds = range(effort.of(ROUNDS))
        times = [(1e3 * counted / flight.rate(), 1e3 / alone.rate()) for _ in rounds]
    ours, peer = zip(*times, strict=True)
    ratios = [one / other for one, other in times]
    note = "" if source == "true" else "Rendering and encoding of the image are not counted."
    said = {"ours_name": "control step of a scene", "peer_name": "its rollout alone"}
    yield record(
        f"Closed loop, {words}", "ms", ours, peer, ratios, target=at_most(1.35), note=note, **said
    )
    shares["taps and everything else"] = 1 - sum(shares.values())
    for part, share in shares.items():
        if share > 0:
            yield record(f"{words}: {part}", "ms", [share * median(ours) / counted])


def _vehicle(source: str, words: str, effort: Effort) -> Iterator[Record]:
    """Time a thousand replans of one vehicle, each by itself."""
    with Running(Work("benchmarks.planning:one_vehicle", {"clearance": source})) as side:
        side.seconds(effort.of(50))
        taken = [1e3 * seconds for seconds in side.seconds(effort.of(REPLANS, 2), "wall")]
    most = quantiles(taken, n=100, method="inclusive")[-1]
    for name, value in (("median", median(taken)), ("99th percentile", most)):
        name = f"One vehicle, {words}: {name}"
        yield record(name, "ms", [value], target=at_most(5.0, "ours"))


def _growth(across: str, effort: Effort) -> Iterator[Found]:
    """Time the rollout over one of its sizes: it should grow no faster than the size."""
    side = "benchmarks.planning:rollout"
    works = {str(size): Work(side, {across: size}) for size in SIZES[across]}
    rates = interleaved(works, effort.of(ROUNDS))
    points = [
        (float(size), 1e3 * (size if across == "scenes" else 1) / median(rates.rounds[str(size)]))
        for size in SIZES[across]
    ]
    yield Curve(name=f"Rollout over {across}", across=across, unit="ms", points=tuple(points))
    (size, time), (end, last) = points[0], points[-1]
    linear = time * end / size
    yield record(
        f"Rollout over {across}: linear",
        "ms",
        *([last], [linear], [last / linear]),
        ours_name=f"{end:g} {across}",
        peer_name=f"{end / size:g} times the time of {size:g}",
        target=at_most(LINEAR),
    )


CLOSED_LOOP: Mapping[str, Case] = {
    f"Closed loop, {words}": partial(_closed, source, words)
    for source, words in (("true", "ground-truth clearance"), ("depth", "learned clearance"))
}
ONE_VEHICLE: Mapping[str, Case] = {
    f"One vehicle, {words}": partial(_vehicle, source, words)
    for source, words in (
        ("field", "distance field"),
        ("depth", "depth image encoded and queried"),
    )
}
GROWTH: Mapping[str, Case] = {
    f"Rollout over {across}: linear": partial(_growth, across) for across in SIZES
}
