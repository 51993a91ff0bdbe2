"""Whether modules that take each other's place have one name, so that a fault strikes both."""

from collections.abc import Sequence
from itertools import combinations

from faultpath.core.text import listed
from faultpath.loop import Module
from faultpath.trials import LoopSystem, System


def other_names(system: System, variants: Sequence[str]) -> tuple[str, ...]:
    """Return a sentence for each two modules that stand for each other under two names.

    They write the same source in two variants and read the same channel.
    """
    if not isinstance(system, LoopSystem):
        return ()
    modules = {name: system.modules(name, None) for name in variants}
    sentences: dict[str, None] = {}
    for one, other in combinations(modules, 2):
        for first in _alone(modules[one], modules[other]):
            for second in _alone(modules[other], modules[one]):
                read = {port.channel for port in first.ports} & {p.channel for p in second.ports}
                if read and {*first.writes} & {*second.writes}:
                    sentences[
                        f"Modules '{first.name}' of {one} and '{second.name}' of {other} read "
                        f"{listed(sorted(read))} and write {listed(sorted(first.writes))}; a fault "
                        "at either one alone reaches one of the two variants. To fault both, give "
                        f'them one name: @writes(..., name="{first.name}").'
                    ] = None
    return tuple(sentences)


def _alone(modules: Sequence[Module], others: Sequence[Module]) -> list[Module]:
    names = {module.name for module in others}
    return [module for module in modules if module.name not in names]
