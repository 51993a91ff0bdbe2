"""Which source comes first, and which others the same repair has to be audited against."""

from collections.abc import Mapping, Sequence
from itertools import groupby
from typing import Any, cast

import numpy as np

from faultpath.core.arrays import is_array, to_numpy
from faultpath.core.errors import UserError
from faultpath.core.text import unknown
from faultpath.decisions.sources import Candidate, bound
from faultpath.interface import Interface, module_of, modules
from faultpath.trials import LoopSystem, System, Variant


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


def repaired_modules(
    system: System, baseline: Variant, repair: Variant, named: Sequence[str]
) -> tuple[str, ...]:
    """Return the modules that the repair changes: as `named`, else as far as can be seen.

    Seen is what reads at other places, writes a source that feeds a channel in one of the variants
    only, or is of another class or has other numbers in it, weights included. `UserError` for a
    name that is no module's.
    """
    interface = system.interface
    known = modules(interface)
    for name in named:
        if name not in known:
            raise UserError(f"{system.name}: {unknown('module', name, known)}")
    repaired = {module_of(reader) for reader in baseline.readers ^ repair.readers}
    for channel in interface.channels:
        fed = {bound(variant, interface, channel.name) for variant in (baseline, repair)}
        if len(fed) > 1:
            repaired |= {module for module, source in interface.reconstructions if source in fed}
    if isinstance(system, LoopSystem):
        one, two = (
            {module.name: module for module in system.modules(variant.name, None)}
            for variant in (baseline, repair)
        )
        repaired |= {name for name in one | two if _differ(one.get(name), two.get(name), set())}
    return tuple(named) or tuple(name for name in known if name in repaired)


def _differ(one: Any, two: Any, seen: set[tuple[int, int]]) -> bool:
    """Return whether two objects are of other classes or hold other numbers, however deep.

    Words are passed over, for they may only be names, and so is what holds nothing to be seen.
    """
    if one is two or (id(one), id(two)) in seen:
        return False
    seen.add((id(one), id(two)))
    if type(one) is not type(two):
        return True
    if is_array(one):
        return not np.array_equal(to_numpy(one), to_numpy(two))
    if isinstance(one, int | float | complex):
        return one != two
    mine, theirs = (
        dict(enumerate(cast("Sequence[Any]", of)))
        if isinstance(of, list | tuple)
        else cast("Mapping[Any, Any]", of if isinstance(of, Mapping) else vars(of))
        if isinstance(of, Mapping) or hasattr(of, "__dict__")
        else {}
        for of in (one, two)
    )
    return mine.keys() != theirs.keys() or any(
        _differ(part, theirs[name], seen) for name, part in mine.items()
    )


def makers(interface: Interface, variants: Sequence[Variant]) -> dict[str, tuple[str, ...]]:
    """Return each module that makes a source which another one reads, with these sources."""
    by_module: dict[str, dict[str, None]] = {}
    for module, source in interface.reconstructions:
        for variant in variants:
            for channel in interface.channels:
                readers = variant.readers.intersection(channel.readers)
                if bound(variant, interface, channel.name) == source and any(
                    module_of(reader) != module for reader in readers
                ):
                    by_module.setdefault(module, {})[source] = None
    return {module: tuple(sources) for module, sources in by_module.items()}


def recursion(
    candidates: Sequence[Candidate], made_by: Mapping[str, Sequence[str]], start: Sequence[str]
) -> dict[str, str]:
    """Return the candidates that modules in `start` lead to, by name, each with why.

    The paper's rule is recursive: what a module makes is a source of others, and depends on what
    it reads, "which require the same audit as its output". So do the inputs of a module that makes
    one of these inputs, and so on.
    """
    why: dict[str, str] = {}
    waiting = [module for module in start if module in made_by]
    for module in waiting:  # grows while it is gone through
        makes = ", ".join(made_by[module])
        for candidate in candidates:
            if set(candidate.sources) & set(made_by[module]):
                why.setdefault(candidate.name, f"output of {module}")
            elif any(module_of(reader) == module for reader in candidate.readers):
                why.setdefault(candidate.name, f"input of {module}, which makes {makes}")
                behind = (
                    m for m, sources in made_by.items() if set(sources) & set(candidate.sources)
                )
                waiting += [m for m in behind if m not in waiting]
    return why
