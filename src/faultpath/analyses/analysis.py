"""Parts that audit, map and scan share: rounds of trials, and what their plans are made of."""

from abc import ABC, abstractmethod
from collections.abc import Generator, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, Generic, TypeAlias, TypeVar

from faultpath.analyses.model import CORRECT, SHARED
from faultpath.core.errors import UserError
from faultpath.core.streams import generator
from faultpath.core.text import unknown
from faultpath.faults import Fault, at_readers, describe
from faultpath.interface import module_of
from faultpath.run.deliveries import Deliveries
from faultpath.run.execution.state import Stop
from faultpath.run.plan import Plan, Row, Treatment
from faultpath.run.question import RepairQuestion, Request
from faultpath.run.trials import Trials
from faultpath.system.declared import Library, Variant
from faultpath.system.system import System

ORDER_SEED = 0
"""One order for each library, so that nobody can choose among several."""
Items = TypeVar("Items")


@dataclass(frozen=True)
class Round:
    """Trials of one round, those of earlier rounds included."""

    plan: Plan
    items: int = 1
    """Number so far of what the analysis adds from round to round."""
    most: int = 1
    """Number expected in the end."""
    notice: str = ""
    """Sentence to be shown before the round."""
    stop: Stop | None = None
    """Called at each analysis of a sequential plan."""


Rounds: TypeAlias = Generator[Round, Trials, Items]
"""Rounds, each from the trials of those before; they return all that they added."""


@dataclass(frozen=True)
class Analysis(ABC, Generic[Items]):
    """A question, the rounds of trials that answer it, and the result that follows from them."""

    noun: ClassVar[str] = ""
    """Plural of that which rounds add; empty for an analysis of one round."""

    question: Request
    system: System
    named: tuple[str, ...]
    """Parts of the name of its folder; system options, scenes and seeds follow."""

    @abstractmethod
    def rounds(self) -> Rounds[Items]:
        """Yield the rounds. `UserError` where trials leave nothing to go on."""

    @abstractmethod
    def conclude(self, trials: Trials, deliveries: Deliveries, items: Items) -> Any:
        """Return the result. `UserError` where nothing is left to compare."""


def two_variants(system: System, question: RepairQuestion) -> tuple[Variant, Variant]:
    """Return baseline and repair; `UserError` for an unknown one, and where both are one."""
    for name in (question.baseline, question.repair):
        if name not in system.variants:
            raise UserError(f"{system.name}: {unknown('variant', name, system.variants)}")
    if question.baseline == question.repair:
        raise UserError(
            f"baseline and repair are both '{question.repair}': name two different variants."
        )
    return system.variants[question.baseline], system.variants[question.repair]


def scenes_of(library: Library, count: int | None, in_order: bool = True) -> tuple[str, ...]:
    """Return the first scenes of a library, in its order or the random one of sequential audits;
    `UserError` for a number that it has not got."""
    available = len(library.scenes)
    if count is not None and not 1 <= count <= available:
        raise UserError(
            f"cannot run {count} scenes of library '{library.name}': choose 1 to {available}."
        )
    scenes = library.scenes
    if not in_order:
        stream = generator("scene order", library.content_hash, ORDER_SEED)
        drawn: list[int] = stream.permutation(available).tolist()
        scenes = tuple(scenes[place] for place in drawn)
    return tuple(scene.id for scene in scenes[:count])


def faults_by_condition(
    faults: Sequence[Fault], variants: Sequence[Variant]
) -> dict[str, dict[str, tuple[Fault, ...]]]:
    """Return the faults of each condition in each variant; none under correct inputs. With a single
    module there is nothing to share: the isolated fault is all of it.

    `UserError` for faults that reach no variant, and a module named like a condition.
    """
    shared = {variant.name: at_readers(faults, variant.readers) for variant in variants}
    reached = (reader for parts in shared.values() for part in parts for reader in part.readers)
    modules = sorted({module_of(reader) for reader in reached})
    if not modules:
        names = " nor ".join(f"'{variant.name}'" for variant in variants)
        raise UserError(
            f"the fault ({describe(faults)}) reaches neither {names}: neither reads it there."
        )
    for reserved in {CORRECT, SHARED} & set(modules):
        raise UserError(
            f"the interface calls a module '{reserved}', which is the name of a condition in every "
            "audit: rename the module."
        )
    conditions: dict[str, dict[str, tuple[Fault, ...]]] = {CORRECT: dict.fromkeys(shared, ())}
    for module in modules:
        conditions[module] = {name: at_readers(parts, (module,)) for name, parts in shared.items()}
    if len(modules) > 1:
        conditions[SHARED] = shared
    return conditions


def rows_of(
    condition: str, faults: Mapping[str, Sequence[Fault]], seeds: Sequence[int]
) -> Iterator[Row]:
    """Yield the rows of a condition: each variant under its faults, once with each seed."""
    for variant, parts in faults.items():
        for seed in seeds:
            treatment = Treatment(variant=variant, faults=tuple(parts), seed=seed)
            yield Row(variant=variant, condition=condition, seed=seed, treatment=treatment)
