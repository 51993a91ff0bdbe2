"""What is measured of the trained models, as plain data that goes to JSON and back."""

from __future__ import annotations

import json
from typing import Any

from pydantic import BaseModel, ConfigDict, Field, JsonValue

FORMAT = "faultpath-learning-quality/1"
_DIGITS = 6
"""Significant digits that are written: the last bits differ between processors."""


class _Plain(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")


class Interval(_Plain):
    """An estimate and the interval of its episode bootstrap."""

    value: float
    low: float
    high: float


class PredictionUnderError(_Plain):
    """The 20-step position error when the supplied calibration is off by `error`."""

    error: float
    median_m: float
    p90_m: float


class PredictorScore(_Plain):
    """Position errors of one model, or the mean of them over seeds."""

    median_m: Interval
    """After the last step."""
    p90_m: float
    """90th percentile over windows after the last step."""
    horizon_m: tuple[float, ...]
    """Median after each step."""
    under_error: tuple[PredictionUnderError, ...]


class PredictorQuality(_Plain):
    """A predictor on the validation windows of a pool."""

    name: str
    pool: str
    wind: str
    """Wind that it is told: `true` or `zero`."""
    seeds: dict[int, PredictorScore]
    """By model seed; empty where nothing is learned."""
    mean: PredictorScore
    """Mean over the seeds."""

    @property
    def stem(self) -> str:
        """Name that tells the rows of a pool apart."""
        return f"{self.name}/{self.wind}"


class ReconstructionUnderError(_Plain):
    """The reconstructed wind when the supplied calibration is off by `error`."""

    error: float
    rmse_mps: float
    vertical_shift_mps: float
    """Mean of the vertical wind minus that under correct calibration."""


class ReconstructionScore(_Plain):
    """Wind errors of one model, or the mean of them over seeds."""

    rmse_mps: Interval
    """Root mean square length of the error vector."""
    by_level: dict[str, float]
    """The same for the windows of each wind level that has any."""
    under_error: tuple[ReconstructionUnderError, ...]


class ReconstructionQuality(_Plain):
    """A wind reconstruction on the validation windows of a pool."""

    name: str
    pool: str
    seeds: dict[int, ReconstructionScore]
    """By model seed; empty where nothing is learned."""
    mean: ReconstructionScore
    """Mean over the seeds."""


class PoolUsed(_Plain):
    """The validation windows of a pool."""

    rows_sha256: str
    windows: int
    episodes: int
    by_level: dict[str, int]
    """Windows by wind level."""


class CheckpointUsed(_Plain):
    """A model that was measured."""

    name: str
    seed: int
    weights_sha256: str
    data_sha256: dict[str, JsonValue]
    """Digest of each pool that it was fitted to."""


class Settings(_Plain):
    """What decides the numbers besides data and weights."""

    history: int
    horizon: int
    step_s: float
    resamples: int
    """Of the episodes, for intervals of 95 %."""
    calibration_errors: tuple[float, ...]
    level_mean_mps: dict[str, float]


class Quality(_Plain):
    """How good the trained models are on windows that none of them was fitted to."""

    format: str = FORMAT
    settings: Settings
    pools: dict[str, PoolUsed]
    checkpoints: tuple[CheckpointUsed, ...]
    missing: tuple[str, ...]
    """Checkpoints that were not there, as `<name>-<seed>`."""
    predictors: tuple[PredictorQuality, ...]
    reconstructions: tuple[ReconstructionQuality, ...]
    clearance: dict[str, JsonValue] | None = Field(default=None)
    """What `clearance_task.evaluate` returns; `None` without a clearance model."""

    def encode(self) -> bytes:
        """Return the file's contents; they depend on data, weights and settings alone."""
        content = _rounded(self.model_dump(mode="json"))
        return (json.dumps(content, indent=1, allow_nan=False) + "\n").encode()


def _rounded(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _rounded(part) for key, part in value.items()}
    if isinstance(value, list):
        return [_rounded(part) for part in value]
    return float(f"{value:.{_DIGITS}g}") if isinstance(value, float) else value
