"""How far models are off on recorded windows: where the vehicle went, and which wind there was."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeVar

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from faultpath.faults import AnyFault
from faultpath.quadrotor.interface import quadrotor_interface
from faultpath.quadrotor.plant.wind import Winds
from faultpath.quadrotor.predictors import Predictor
from faultpath.quadrotor.presets import calibration
from faultpath.quadrotor.reconstruction import Reconstruction
from faultpath.quadrotor.training.playback import HELD, at_present
from faultpath.quadrotor.training.quality_intervals import Drawn, Episodes
from faultpath.quadrotor.training.quality_results import (
    PredictionUnderError,
    PredictorQuality,
    PredictorScore,
    ReconstructionQuality,
    ReconstructionScore,
    ReconstructionUnderError,
)
from faultpath.quadrotor.training.windows import HISTORY, Windows

ERRORS = (-0.2, -0.1, 0.0, 0.1, 0.2)
"""Coupled calibration errors e: m~ = m (1 + e), T~ = T (1 - e) (paper, Section IV-B)."""
_CORRECT = ERRORS.index(0.0)

Floats = NDArray[np.float64]
Score = TypeVar("Score", PredictorScore, ReconstructionScore)


@dataclass(frozen=True)
class Row:
    """A predictor, the pool that it is measured on, and the wind that it is told."""

    name: str
    pool: str
    wind: str = "true"


PREDICTORS = (
    *(
        Row(name, "nominal")
        for name in ("dki", "dki-drag", "true-parameter", "wm-a", "wm-a+dcc", "wm-u", "wm-u+dcc")
    ),
    Row("dki-drag", "wind"),
    Row("true-parameter", "wind"),
    Row("wm-a-wind", "wind"),
    Row("wm-a-wind", "wind", "zero"),
    Row("wm-a-nowind", "wind"),
)
RECONSTRUCTIONS = tuple(
    Row(name, "wind") for name in ("dob", "gru", "gru+dcc", "gru-withheld", "gru-trajectory")
)


def position_errors(
    predictor: Predictor, windows: Windows, error: float = 0.0, wind: str = "true"
) -> Tensor:
    """Return the distance of predicted from recorded positions after each step, `[20, W]`, m.

    Args:
        predictor: Whose rollouts are compared.
        windows: Recorded windows.
        error: Coupled error of the calibration at all its readers.
        wind: `true`, or `zero`: what the predictor is told of it.
    """
    bindings = {"wind": f"{wind}_wind"}
    present = at_present(windows, predictor, None, bindings, _faults(predictor, error))
    steps = zip(
        present.positions().unbind(-1), windows.position[:, HISTORY + 1 :].unbind(1), strict=True
    )
    return torch.stack([(predicted - there).norm(dim=0) for predicted, there in steps])


def estimate(reconstruction: Reconstruction, windows: Windows, error: float = 0.0) -> Tensor:
    """Return the wind at the present of every window, `[3, W]`, m/s."""
    bindings = {"wind": "reconstructed_wind"}
    return at_present(
        windows, None, reconstruction, bindings, _faults(reconstruction, error)
    ).wind()


def levels(windows: Windows, winds: Winds) -> NDArray[np.str_]:
    """Return the wind level of each window, `[W]`: the one whose sustained speed is nearest.

    The mean wind over the window stands for the sustained one. The pool's winds reach beyond L3,
    which takes all that are stronger.
    """
    speed = windows.wind_mps.mean(1).norm(dim=0)
    means = torch.tensor([level.mean_mps for level in winds.levels.values()])
    nearest = (speed - means[:, None]).abs().argmin(0)
    return np.array(list(winds.levels))[nearest.numpy()]


def measure_predictor(
    row: Row, models: Mapping[int | None, Predictor], windows: Windows, episodes: Episodes
) -> PredictorQuality:
    """Return the errors of the models of one row, by seed (`None`: nothing is learned)."""
    found: dict[int | None, tuple[Drawn, PredictorScore]] = {}
    for seed, model in models.items():
        missed = [
            position_errors(model, windows, error, row.wind).double().numpy() for error in ERRORS
        ]
        median = episodes.median(missed[_CORRECT][-1])
        found[seed] = (
            median,
            PredictorScore(
                median_m=median.interval(),
                p90_m=_p90(missed[_CORRECT]),
                horizon_m=tuple(float(value) for value in np.median(missed[_CORRECT], axis=1)),
                under_error=tuple(
                    PredictionUnderError(
                        error=error, median_m=float(np.median(each[-1])), p90_m=_p90(each)
                    )
                    for error, each in zip(ERRORS, missed, strict=True)
                ),
            ),
        )
    return PredictorQuality(
        name=row.name,
        pool=row.pool,
        wind=row.wind,
        seeds=_by_seed(found),
        mean=_mean(list(found.values()), "median_m"),
    )


def measure_reconstruction(
    row: Row,
    models: Mapping[int | None, Reconstruction],
    windows: Windows,
    episodes: Episodes,
    winds: Winds,
) -> ReconstructionQuality:
    """Return the errors of one reconstruction, by seed (`None`: nothing is learned)."""
    level, truth = levels(windows, winds), windows.wind_mps[:, HISTORY]
    found: dict[int | None, tuple[Drawn, ReconstructionScore]] = {}
    for seed, model in models.items():
        found_mps = [estimate(model, windows, error) for error in ERRORS]
        squared = [(each - truth).square().sum(0).double().numpy() for each in found_mps]
        rmse = episodes.root_mean_square(squared[_CORRECT])
        found[seed] = (
            rmse,
            ReconstructionScore(
                rmse_mps=rmse.interval(),
                by_level={
                    name: float(np.sqrt(squared[_CORRECT][level == name].mean()))
                    for name in np.unique(level).tolist()
                },
                under_error=tuple(
                    ReconstructionUnderError(
                        error=error,
                        rmse_mps=float(np.sqrt(each.mean())),
                        vertical_shift_mps=float((wind - found_mps[_CORRECT])[2].mean()),
                    )
                    for error, each, wind in zip(ERRORS, squared, found_mps, strict=True)
                ),
            ),
        )
    return ReconstructionQuality(
        name=row.name,
        pool=row.pool,
        seeds=_by_seed(found),
        mean=_mean(list(found.values()), "rmse_mps"),
    )


def _faults(model: Predictor | Reconstruction, error: float) -> list[AnyFault]:
    interface = quadrotor_interface()
    readers = {name for channel in HELD for name in interface.channel(channel).consumers}
    return [calibration(error)] if model.consumers() & readers else []


def _p90(missed: Floats) -> float:
    return float(np.quantile(missed[-1], 0.9))


def _by_seed(found: Mapping[int | None, tuple[Drawn, Score]]) -> dict[int, Score]:
    return {seed: score for seed, (_, score) in found.items() if seed is not None}


def _mean(found: Sequence[tuple[Drawn, Score]], headline: str) -> Score:
    drawn, scores = zip(*found, strict=True)
    mean = _average([score.model_dump() for score in scores])
    return type(scores[0])(**mean | {headline: Drawn.mean(drawn).interval()})


def _average(parts: Sequence[Any]) -> Any:
    first = parts[0]
    if isinstance(first, dict):
        return {key: _average([part[key] for part in parts]) for key in first}
    if isinstance(first, tuple):
        return tuple(_average(each) for each in zip(*parts, strict=True))
    return first if parts.count(first) == len(parts) else float(np.mean(parts))
