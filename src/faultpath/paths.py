"""The paths of a fault, correct inputs, each module alone and shared, and what they strike."""

from collections.abc import Sequence

from faultpath.errors import UserError
from faultpath.faults import AnyFault, Fault
from faultpath.interface import Interface, module_of
from faultpath.record import CORRECT, SHARED, Path
from faultpath.trials import Arm, System, Variant


def strikes_of(
    interface: Interface, fault: AnyFault, variants: Sequence[Variant]
) -> dict[str, AnyFault | None]:
    """Return the fault of each path; `None` under correct inputs. With a single module there is
    nothing to share: the isolated fault is all of it.

    `UserError` for a fault that reaches no variant, and a module named like a path.
    """
    reached = [c for variant in variants for c in _struck(interface, fault, variant)]
    if not reached:
        names = " nor ".join(f"'{variant.name}'" for variant in variants)
        raise UserError(
            f"the fault ({fault.describe()}) reaches neither {names}: neither reads it there."
        )
    by_module: dict[str, list[str]] = {}
    for consumer in reached:
        places = by_module.setdefault(module_of(consumer), [])
        if consumer not in places:
            places.append(consumer)
    for reserved in {CORRECT, SHARED} & set(by_module):
        raise UserError(
            f"the interface calls a module '{reserved}', which is the name of a path of every "
            "audit: rename the module."
        )
    paths: dict[str, AnyFault | None] = {CORRECT: None}
    paths |= {module: fault.striking(*by_module[module]) for module in sorted(by_module)}
    if len(by_module) > 1:
        paths[SHARED] = fault.striking(*(c for name in sorted(by_module) for c in by_module[name]))
    return paths


def _struck(interface: Interface, fault: AnyFault | None, variant: Variant) -> tuple[str, ...]:
    consumers = (c for f in _resolved(interface, fault, variant) for c in f.consumers)
    return tuple(dict.fromkeys(consumers))


def _resolved(interface: Interface, fault: AnyFault | None, variant: Variant) -> tuple[Fault, ...]:
    return () if fault is None else fault.resolved(interface, variant.consumers)


def path_struck(
    name: str, interface: Interface, fault: AnyFault | None, variants: Sequence[Variant]
) -> Path:
    """Return a path with the consumers that the fault strikes in the repair and the baseline."""
    baseline, repair = variants
    titles = {CORRECT: "Correct inputs", SHARED: "Shared fault"}
    return Path(
        name=name,
        title=titles.get(name, f"{name.replace('_', ' ').capitalize()} only"),
        consumers=_struck(interface, fault, repair),
        baseline_consumers=_struck(interface, fault, baseline),
    )


def arm_struck(system: System, variant: Variant, fault: AnyFault | None, seed: int) -> Arm:
    """Return the arm with its fault spelled out: where the fault cannot reach the variant, that
    is the arm under correct inputs, which runs once."""
    faults = _resolved(system.interface, fault, variant)
    return Arm(variant=variant.name, faults=faults, seed=seed)
