"""How far the reconstructed wind of recorded windows is from the true one."""

from collections.abc import Mapping, Sequence

import numpy as np
import torch
from numpy.typing import NDArray

from faultpath.quadrotor.reconstruction import Reconstruction
from faultpath.quadrotor.training.quality_intervals import Drawn, Episodes
from faultpath.quadrotor.training.quality_predictors import ERRORS, supply
from faultpath.quadrotor.training.quality_results import (
    ReconstructionQuality,
    ReconstructionScore,
    ReconstructionUnderError,
)
from faultpath.quadrotor.training.replay import estimate
from faultpath.quadrotor.training.windows import HISTORY, Windows
from faultpath.quadrotor.wind import WIND_LEVELS

POOL = "wind"
NAMES = ("dob", "gru", "gru+dcc", "gru-withheld", "gru-trajectory")

Floats = NDArray[np.float64]


def levels(windows: Windows) -> NDArray[np.str_]:
    """Return the wind level of each window, `[W]`: the one whose sustained speed is nearest.

    The mean wind over the window stands for the sustained one. The pool's winds reach beyond L3,
    which takes all that are stronger.
    """
    speed = windows.wind_mps.mean(1).norm(dim=0)
    means = torch.tensor([level.mean_mps for level in WIND_LEVELS.values()])
    nearest = (speed - means[:, None]).abs().argmin(0)
    return np.array(list(WIND_LEVELS))[nearest.numpy()]


def measure(
    name: str,
    models: Mapping[int | None, Reconstruction],
    windows: Windows,
    episodes: Episodes,
) -> ReconstructionQuality:
    """Return the errors of one reconstruction, by seed (`None`: nothing is learned)."""
    consumers = next(iter(models.values())).consumers()
    calibrations = [supply(windows, consumers, error) for error in ERRORS]
    level = levels(windows)
    truth = windows.wind_mps[:, HISTORY]
    rmse: list[Drawn] = []
    scores: dict[int | None, ReconstructionScore] = {}
    for seed, model in models.items():
        found = [estimate(model, windows, delivered) for delivered in calibrations]
        squared = [(each - truth).square().sum(0).double().numpy() for each in found]
        correct = ERRORS.index(0.0)
        rmse.append(episodes.root_mean_square(squared[correct]))
        shifts = [float((each - found[correct])[2].mean()) for each in found]
        scores[seed] = ReconstructionScore(
            rmse_mps=rmse[-1].interval(),
            by_level=_by_level(squared[correct], level),
            under_error=tuple(
                ReconstructionUnderError(
                    error=error, rmse_mps=float(np.sqrt(each.mean())), vertical_shift_mps=shift
                )
                for error, each, shift in zip(ERRORS, squared, shifts, strict=True)
            ),
        )
    return ReconstructionQuality(
        name=name,
        pool=POOL,
        seeds={seed: score for seed, score in scores.items() if seed is not None},
        mean=_mean(Drawn.mean(rmse), list(scores.values())),
    )


def _by_level(squared: Floats, level: NDArray[np.str_]) -> dict[str, float]:
    return {
        name: float(np.sqrt(squared[level == name].mean()))
        for name in WIND_LEVELS
        if (level == name).any()
    }


def _mean(rmse: Drawn, scores: Sequence[ReconstructionScore]) -> ReconstructionScore:
    """Return the mean of scores, with the interval of the mean error."""
    under_error = zip(*(score.under_error for score in scores), strict=True)
    return ReconstructionScore(
        rmse_mps=rmse.interval(),
        by_level={
            name: float(np.mean([score.by_level[name] for score in scores]))
            for name in scores[0].by_level
        },
        under_error=tuple(
            ReconstructionUnderError(
                error=each[0].error,
                rmse_mps=float(np.mean([one.rmse_mps for one in each])),
                vertical_shift_mps=float(np.mean([one.vertical_shift_mps for one in each])),
            )
            for each in under_error
        ),
    )
