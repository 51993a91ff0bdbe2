"""Parts of the plans of all analyses: variants, scenes, and rows under the conditions of a
fault."""

from collections.abc import Iterator, Mapping, Sequence

from faultpath.analyses.model import CORRECT, SHARED
from faultpath.core.errors import UserError
from faultpath.core.streams import generator
from faultpath.core.text import unknown
from faultpath.faults import Fault, at_readers, describe
from faultpath.interface import module_of
from faultpath.run.plan import Row, Treatment
from faultpath.run.question import RepairQuestion
from faultpath.system.declared import Library, Variant
from faultpath.system.system import System

ORDER_SEED = 0
"""One order for each library, so that nobody can choose among several."""


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
