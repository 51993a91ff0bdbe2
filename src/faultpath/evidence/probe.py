"""How far predictions move when an input is perturbed and everything else stays (paper, III-B)."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict

from faultpath.errors import UserError
from faultpath.evidence.model import Measurement, Recording
from faultpath.evidence.table import EvidenceTable
from faultpath.interface import Interface, groups
from faultpath.statistics import Estimate, WindowQuantiles

_CM = 100.0


class _Frozen(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")


class ProbeRow(_Frozen):
    """The response of one variant to one perturbation."""

    variant: str
    perturbation: str
    response_cm: Estimate
    """Median over windows of the distance between the two predictions after the last step."""
    log_ratio: Estimate | None
    """Logarithm of the response over that of the first variant; `None` for the first itself, and
    where a prediction did not move at all."""


class Probe(_Frozen):
    """Responses by perturbation, then by variant."""

    recording: Recording
    seeds: tuple[int, ...]
    scenes: int
    """Scenes whose flights have windows."""
    windows: int
    rows: tuple[ProbeRow, ...]


@dataclass(frozen=True)
class ProbePlan:
    """A probe of several variants on the windows of one recording."""

    recording: Recording
    variants: tuple[str, ...]
    perturbations: tuple[str, ...]
    seeds: tuple[int, ...] = (0,)

    def __post_init__(self) -> None:
        for what in ("variants", "perturbations", "seeds"):
            given = getattr(self, what)
            if not given or len(set(given)) < len(given):
                raise UserError(
                    f"a probe needs its {what} once each, and got {', '.join(map(str, given))!r}"
                )

    def measurements(self) -> tuple[Measurement, ...]:
        """Return what has to be measured."""
        return tuple(
            self._measurement(variant, perturbation, seed)
            for perturbation in self.perturbations
            for variant in self.variants
            for seed in self.seeds
        )

    def conclude(self, table: EvidenceTable) -> Probe:
        """Return medians and ratios with intervals that resample scenes."""
        windows = table.values(self.measurements()[0])
        drawn = WindowQuantiles(windows.scenes)
        rows: list[ProbeRow] = []
        for perturbation in self.perturbations:
            first = self._responses(table, self.variants[0], perturbation)
            for variant in self.variants:
                own = self._responses(table, variant, perturbation)
                compared = variant != self.variants[0] and bool((own > 0).all() & (first > 0).all())
                ratio = drawn.log_ratio(own, first, 0.5).estimate() if compared else None
                response = drawn.value(own, 0.5, "cm").estimate()
                rows.append(
                    ProbeRow(
                        variant=variant,
                        perturbation=perturbation,
                        response_cm=response,
                        log_ratio=ratio,
                    )
                )
        return Probe(
            recording=self.recording,
            seeds=self.seeds,
            scenes=drawn.resamples.n_scenes,
            windows=len(windows),
            rows=tuple(rows),
        )

    def _measurement(self, variant: str, perturbation: str, seed: int) -> Measurement:
        return Measurement(
            recording=self.recording,
            quantity="position-response",
            subject=variant,
            seed=seed,
            faults=(perturbation,),
        )

    def _responses(
        self, table: EvidenceTable, variant: str, perturbation: str
    ) -> NDArray[np.float64]:
        columns = [
            table.values(self._measurement(variant, perturbation, seed)).values
            for seed in self.seeds
        ]
        return _CM * np.stack(columns, axis=1)


def expected_perturbations(interface: Interface, presets: Collection[str]) -> Sequence[str]:
    """Return one perturbation for each group of sources that err together, as large as declared.

    That is a group with a preset of its name whose sources all declare the same relative half-range
    (paper, Section III-C: "perturbations scaled to expected deployment uncertainty"). `UserError`
    where there is none.
    """
    found: list[str] = []
    for group in groups(interface):
        sources = [source for source in interface.sources if source.correlation_group == group]
        sizes = {
            source.uncertainty.half_range
            if source.uncertainty is not None and source.uncertainty.relative
            else None
            for source in sources
        }
        size = sizes.pop() if len(sizes) == 1 else None
        if group in presets and size is not None:
            found.append(f"{group}=+{size:g}")
    if not found:
        raise UserError(
            "the interface declares no uncertainty that a named fault covers: say what to perturb, "
            "for example --perturb CHANNEL:scale=1.1"
        )
    return found
