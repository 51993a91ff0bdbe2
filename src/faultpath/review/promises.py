"""Whether a system keeps what every system promises: trials that end, repeat and can be paired."""

from collections.abc import Iterable, Iterator

from faultpath.interface import Provenance
from faultpath.review.flights import Flown
from faultpath.review.report import Check
from faultpath.review.seen import Seen
from faultpath.trials.deliveries import unproven
from faultpath.trials.pairing import Mismatch, Side, mismatch_words, unlike

_NOTHING = "no variant flew to its end"


def trials(seen: Seen) -> Check:
    """Every trial ends in an outcome."""
    failures = tuple(
        f"{said}; let every trial end in an outcome, see it with `faultpath audit --workers 0`."
        for said in seen.errors("trials")
    )
    count = sum(len(flown.outcomes) for _, flown in seen.firsts())
    return Check(name="trials end", says=f"{count} under correct inputs", failures=failures)


def determinism(seen: Seen) -> Check:
    """The same scenes twice give the same bits."""
    found = [(name, differs) for name, _ in seen.firsts() if (differs := seen.other(name, "again"))]
    failures = tuple(
        f"Variant '{name}' flown twice over the same scenes {differs}; take random numbers from "
        "faultpath.streams, and look for threads, hash(), clocks and what is kept between calls."
        for name, differs in found
    )
    where = "in two processes" if seen.apart else "in one process"
    return _check(seen, "determinism", f"flown twice {where}, the same bits", failures)


def independence(seen: Seen) -> Check:
    """A scene's result depends neither on the others nor on their order."""
    name = "scene independence"
    if determinism(seen).failures:
        return Check(name=name, says="results do not repeat in any order", judged=False)
    if len(seen.scenes) < 2:
        return Check(name=name, says="one scene has no others beside it", judged=False)
    ways = {"turned": "in another order", "part": "without some of the scenes beside it"}
    failures: list[str] = []
    rounded: list[str] = []
    for variant, _ in seen.firsts():
        for why, how in ways.items():
            if not (differs := seen.other(variant, why)):
                continue
            if (size := seen.size(variant, why)) <= seen.rounding:
                rounded.append(
                    f"Variant '{variant}' flown {how} differs by rounding alone, at most "
                    f"{size:.1g} of a number's size: only with blocks of the same scenes "
                    "does an audit repeat to the bit."
                )
            else:
                failures.append(
                    f"Variant '{variant}' flown {how} {differs}; let nothing that scenes of one "
                    "call of run() share decide a result, and draw by scene."
                )
    bits = "the same to rounding" if rounded else "the same bits"
    says = f"in another order and without some others, {bits}"
    found = _check(seen, name, says, failures)
    return found.model_copy(update={"remarks": tuple(rounded)})


def pairing(seen: Seen) -> Check:
    """Two arms meet the same conditions in each scene."""
    flown = list(seen.firsts())
    sides = [(Side(name, "correct inputs"), each) for name, each in flown]
    sides += [
        (Side(name, "a fault"), each)
        for name, _ in flown
        if not (each := seen.of(name, "faulted")).error and each.outcomes
    ]
    mismatches = [each for side in sides[1:] for each in _mismatches(seen, sides[0], side)]
    remedy = "draw what a scene meets by scene and seed, whatever the variant and the fault."
    failures = [
        f"{said[0].upper()}{said[1:].rstrip('.')}; {remedy}" for said in mismatch_words(mismatches)
    ]
    failures += unproven([outcome for _, each in flown for outcome in each.outcomes])
    if not failures:
        failures += _begin_otherwise(seen, flown)
    alike = f"{len(sides)} arms, the same initial states, disturbances and planner noise"
    return _check(seen, "pairing", alike, failures)


def _mismatches(seen: Seen, one: tuple[Side, Flown], two: tuple[Side, Flown]) -> Iterator[Mismatch]:
    for a, b in zip(one[1].outcomes, two[1].outcomes, strict=True):
        if found := unlike(a, b):
            yield Mismatch(one[0], two[0], a.scene, seen.seed, found)


def _begin_otherwise(seen: Seen, flown: list[tuple[str, Flown]]) -> Iterator[str]:
    """Name measured sources that begin otherwise in another variant although the hashes agree."""
    measured = {
        source.name
        for source in seen.system.interface.sources
        if source.provenance in (Provenance.MEASURED, Provenance.PRIVILEGED)
    }
    known: dict[str, tuple[str, tuple[bytes, ...]]] = {}
    looked: set[tuple[str, str]] = set()
    for name, each in flown:
        for read in each.reads:
            if read.step or read.valid_step or read.source not in measured or read.asks > 1:
                continue
            if (name, read.source) in looked:
                continue
            looked.add((name, read.source))
            first, given = known.setdefault(read.source, (name, read.given))
            odd = [i for i, (a, b) in enumerate(zip(given, read.given, strict=False)) if a != b]
            if odd:
                yield (
                    f"Source '{read.source}' begins otherwise in '{first}' and '{name}' in scene "
                    f"{seen.scenes[odd[0]]!r}, although their hashes agree; hash all that a scene "
                    "begins with, and begin alike in every variant."
                )
                return


def _check(seen: Seen, name: str, says: str, failures: Iterable[str]) -> Check:
    judged = any(True for _ in seen.firsts())
    return Check(
        name=name, says=says if judged else _NOTHING, failures=tuple(failures), judged=judged
    )
