"""The errors of a scan: their sizes and signs, where they act, and which of them act together."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from itertools import combinations
from typing import NamedTuple

from faultpath.analyses.scan.model import ScanError
from faultpath.analyses.scan.sources import Candidate
from faultpath.core.errors import UserError
from faultpath.faults import Fault, FaultText, at_readers
from faultpath.stats.cancelling import MOST
from faultpath.system.system import System


class Scanned(NamedTuple):
    """Errors of a scan, with the choices that its rounds led to."""

    tried: tuple[ScanError, ...]
    """With every size that was run in the first stage."""
    errors: tuple[ScanError, ...]
    """With the size that they have in the second stage."""
    chosen: tuple[int, ...]
    """Those that hurt in the first stage."""
    singles: tuple[int, ...]
    """Those that run alone in the second stage: the chosen ones, and those of the same source and
    sign."""
    pairs: tuple[tuple[int, int], ...]
    together: tuple[tuple[int, ...], ...]
    """Those of one source and sign, at all of its readers, or at all but one of three or more."""
    first: tuple[str, ...]
    """Scenes of the first stage."""
    second: tuple[str, ...] = ()
    """Scenes of the second."""

    @property
    def conditions(self) -> tuple[tuple[int, ...], ...]:
        """Errors that act together in the second stage, each set of them once; first none."""
        every = ((), *((place,) for place in self.singles), *self.pairs, *self.together)
        return tuple(dict.fromkeys(every))


def errors_of(system: System, candidates: Iterable[Candidate]) -> tuple[ScanError, ...]:
    """Return the error of every source that has a size, at each module that reads it, in both
    signs; they stand in the order of their names, whatever that of the declaration.

    A preset of which the system refuses the opposite sign has one.
    """
    errors = [
        error
        for candidate in candidates
        for module in candidate.modules
        if (text := candidate.at.get(module, candidate.fault))
        for error in _signed(system, candidate, module, FaultText.read(text))
    ]
    return tuple(sorted(errors, key=lambda error: (error.source, error.reader, error.fault)))


def _signed(
    system: System, candidate: Candidate, module: str, fault: FaultText
) -> Iterable[ScanError]:
    sources = [system.interface.source(name) for name in candidate.sources]
    declared = [source.uncertainty for source in sources if source.uncertainty]
    size = _change(fault)
    for change in (size, tuple(-part for part in size)):
        sized = _sized(fault, change)
        try:
            system.fault(sized)
        except UserError:
            if fault.kind is not None or change == size:
                raise
            continue
        yield ScanError(
            source=candidate.name,
            reader=module,
            at=fault.readers if module in candidate.at else (module,),
            fault=sized,
            sign=1 if next(part for part in change if part) > 0 else -1,
            change=change,
            relative=fault.kind == "scale"
            or (fault.kind is None and any(error.relative for error in declared)),
            unit=sources[0].unit if fault.kind == "offset" else "",
        )


def halved(error: ScanError) -> ScanError:
    """Return the same error with half the size."""
    change = tuple(part / 2.0 for part in error.change)
    fault = _sized(FaultText.read(error.fault), change)
    return error.model_copy(
        update={"change": change, "fault": fault, "halvings": error.halvings + 1}
    )


def _change(fault: FaultText) -> tuple[float, ...]:
    """Return what a size adds to the reading, or to the factor 1."""
    middle = 1.0 if fault.kind == "scale" else 0.0
    try:
        change = tuple(round(float(p) - middle, 12) for p in fault.sizes[0].split("/"))
    except ValueError:
        raise UserError(f"fault '{fault}': '{fault.sizes[0]}' is no number.") from None
    if not any(change):
        raise UserError(f"fault '{fault}' changes nothing: give a size that does.")
    return change


def _sized(fault: FaultText, change: Sequence[float]) -> str:
    middle = 1.0 if fault.kind == "scale" else 0.0
    form = "+.12g" if fault.kind is None else ".12g"
    size = "/".join(f"{middle + part:{form}}" for part in change)
    return replace(fault, readers=()).at(size).text


def faults_of(system: System, errors: Sequence[ScanError]) -> tuple[Fault, ...]:
    """Return the faults of errors that act together: one at all of its readers where sizes are
    equal, as an audit has it."""
    places: dict[str, list[str]] = {}
    for error in errors:
        places.setdefault(error.fault, []).extend(error.at)
    return tuple(
        fault for text, at in places.items() for fault in at_readers(system.fault(text), at)
    )


def label(errors: Sequence[ScanError]) -> str:
    """Return what trials under some errors are called in the table of outcomes."""
    return " & ".join(error.text for error in errors)


def by_source(errors: Sequence[ScanError]) -> Mapping[tuple[str, int], tuple[int, ...]]:
    """Return the places of the errors of each source and sign, one a reader."""
    groups: dict[tuple[str, int], list[int]] = {}
    for place, error in enumerate(errors):
        groups.setdefault((error.source, error.sign), []).append(place)
    return {key: tuple(places) for key, places in groups.items()}


def most_conditions(errors: Sequence[ScanError]) -> tuple[int, int, int]:
    """Return the most errors, pairs and conditions that a second stage may have."""
    groups = sorted(map(len, by_source(errors).values()), reverse=True)
    chosen = min(MOST, len(errors))
    singles = min(len(errors), sum(groups[:chosen]))
    allowed = sum(different(errors, pair) for pair in combinations(range(len(errors)), 2))
    alike = sum(n * (n - 1) // 2 for n in groups[:chosen])
    pairs = min(allowed, chosen * (chosen - 1) // 2 + alike)
    together = sum(n > 1 for n in groups) + sum(n for n in groups if n > 2)
    return singles, pairs, 1 + singles + pairs + together


def different(errors: Sequence[ScanError], pair: tuple[int, int]) -> bool:
    """Return whether two errors may act together: of two sources, or of one and of one sign."""
    one, two = (errors[place] for place in pair)
    return one.source != two.source or (one.sign == two.sign and one.reader != two.reader)
