"""Which source comes first: number of readers, then how far its error moves the commands."""

from collections.abc import Sequence
from itertools import groupby

from faultpath.analyses.model import SHARED
from faultpath.analyses.scan.probing import command_responses
from faultpath.analyses.scan.sources import Candidate
from faultpath.faults import Fault, at_readers
from faultpath.system.declared import Variant
from faultpath.system.loop_system import LoopSystem
from faultpath.system.system import System

PROBED_SCENES = 5
"""A probe is a look at where to begin, and no result."""


def ranking(
    system: System,
    variants: Sequence[Variant],
    candidates: Sequence[Candidate],
    scenes: Sequence[str],
    seed: int,
) -> tuple[Candidate, ...]:
    """Return the sources ranked, those of a loop system with the response to their errors."""
    responses: dict[str, float] = {}
    if isinstance(system, LoopSystem):
        for variant in variants:
            faults = {
                (candidate.name, reach): parts
                for candidate in candidates
                for reach, parts in _conditions(system, variant, candidate).items()
                if parts
            }
            moved = command_responses(system, variant.name, faults, scenes, seed)
            for (name, _), value in moved.items():
                responses[name] = max(value, responses.get(name, value))
    return ranked([c.model_copy(update={"response": responses.get(c.name)}) for c in candidates])


def _conditions(
    system: System, variant: Variant, candidate: Candidate
) -> dict[str, tuple[Fault, ...]]:
    """Return the error of a source at each module alone and at all of them, in a variant."""
    alone = {
        module: at_readers(at_readers(system.fault(text), variant.readers), (module,))
        for module in candidate.modules
        if (text := candidate.at.get(module, candidate.fault))
    }
    return {**alone, SHARED: tuple(fault for faults in alone.values() for fault in faults)}


def ranked(candidates: Sequence[Candidate]) -> tuple[Candidate, ...]:
    """Return candidates, the one with most readers and then the largest probe response first.

    This is the paper's rule, Section III-C. It compares point estimates: sources that are equal in
    both share a rank, and stand in the order of declaration, those without a fault last. A response
    that is not known counts as the smallest.
    """

    def key(candidate: Candidate) -> tuple[int, float]:
        return -len(candidate.readers), 1.0 if candidate.response is None else -candidate.response

    out: list[Candidate] = []
    for _, alike in groupby(
        sorted(candidates, key=lambda candidate: (*key(candidate), not candidate.fault)), key
    ):
        rank = len(out) + 1
        out += [candidate.model_copy(update={"rank": rank}) for candidate in alike]
    return tuple(out)
