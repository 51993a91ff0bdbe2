"""How far predictions of recorded windows end from where the vehicle went."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from faultpath.quadrotor.interface import quadrotor_interface
from faultpath.quadrotor.predictors import Predictor
from faultpath.quadrotor.presets import calibration
from faultpath.quadrotor.training.corruption import Corruption
from faultpath.quadrotor.training.quality_intervals import Drawn, Episodes
from faultpath.quadrotor.training.quality_results import (
    PredictionUnderError,
    PredictorQuality,
    PredictorScore,
)
from faultpath.quadrotor.training.replay import WIND, DeliveredInputs, by_batch, predict
from faultpath.quadrotor.training.windows import HISTORY, Windows

ERRORS = (-0.2, -0.1, 0.0, 0.1, 0.2)
"""Coupled calibration errors e: m~ = m (1 + e), T~ = T (1 - e) (paper, Section IV-B)."""

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Row:
    """A predictor, the pool that it is measured on, and the wind that it is told."""

    name: str
    pool: str
    wind: str = "true"


ROWS = (
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


def supply(windows: Windows, consumers: frozenset[str], error: float) -> DeliveredInputs:
    """Return the calibration that taps deliver to `consumers` under a coupled error, each `[W]`.

    Consumers that read no calibration are left alone: there is nothing to corrupt.
    """
    readings = windows.calibration
    interface = quadrotor_interface()
    readers = {name for channel in readings for name in interface.channel(channel).consumers}
    faults = [calibration(error)] if consumers & readers else []
    return Corruption(interface, faults, consumers, windows.ids, 0).deliver(0, readings)


def position_errors(
    predictor: Predictor, windows: Windows, delivered: DeliveredInputs, wind: str = "true"
) -> Tensor:
    """Return the distance of predicted from recorded positions after each step, `[20, W]`, m."""
    if wind == "zero":
        delivered = {**delivered, WIND: windows.mass_kg.new_zeros(len(windows), 3)}

    def missed(windows: Windows, delivered: DeliveredInputs) -> Tensor:
        ahead = windows.position[:, HISTORY + 1 :].unbind(1)
        states = predict(predictor, windows, delivered)
        return torch.stack(
            [
                (state.position[..., 0] - there).norm(dim=0)
                for state, there in zip(states, ahead, strict=True)
            ]
        )

    return by_batch(missed, windows, delivered)


def measure(
    row: Row, models: Mapping[int | None, Predictor], windows: Windows, episodes: Episodes
) -> PredictorQuality:
    """Return the errors of the models of one row, by seed (`None`: nothing is learned)."""
    consumers = next(iter(models.values())).consumers()
    calibrations = [supply(windows, consumers, error) for error in ERRORS]
    missed = {
        seed: [
            position_errors(model, windows, delivered, row.wind).double().numpy()
            for delivered in calibrations
        ]
        for seed, model in models.items()
    }
    medians = {seed: episodes.median(_correct(each)[-1]) for seed, each in missed.items()}
    scores = {seed: _score(medians[seed], each) for seed, each in missed.items()}
    return PredictorQuality(
        name=row.name,
        pool=row.pool,
        wind=row.wind,
        seeds={seed: score for seed, score in scores.items() if seed is not None},
        mean=_mean(Drawn.mean(list(medians.values())), list(scores.values())),
    )


def _correct(missed: Sequence[Floats]) -> Floats:
    return missed[ERRORS.index(0.0)]


def _score(median: Drawn, missed: Sequence[Floats]) -> PredictorScore:
    """Return the statistics of errors `[20, W]`, one array a calibration error."""
    correct = _correct(missed)
    return PredictorScore(
        median_m=median.interval(),
        p90_m=_p90(correct),
        horizon_m=tuple(float(value) for value in np.median(correct, axis=1)),
        under_error=tuple(
            PredictionUnderError(error=error, median_m=float(np.median(each[-1])), p90_m=_p90(each))
            for error, each in zip(ERRORS, missed, strict=True)
        ),
    )


def _p90(missed: Floats) -> float:
    return float(np.quantile(missed[-1], 0.9))


def _mean(median: Drawn, scores: Sequence[PredictorScore]) -> PredictorScore:
    """Return the mean of scores, with the interval of the mean median."""
    under_error = zip(*(score.under_error for score in scores), strict=True)
    return PredictorScore(
        median_m=median.interval(),
        p90_m=float(np.mean([score.p90_m for score in scores])),
        horizon_m=tuple(
            float(value) for value in np.mean([score.horizon_m for score in scores], axis=0)
        ),
        under_error=tuple(
            PredictionUnderError(
                error=each[0].error,
                median_m=float(np.mean([one.median_m for one in each])),
                p90_m=float(np.mean([one.p90_m for one in each])),
            )
            for each in under_error
        ),
    )
