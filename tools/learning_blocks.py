"""Tables of `docs/learning-quality.md`, in Markdown, from what was measured."""

from collections.abc import Callable, Iterable, Mapping, Sequence

from faultpath.quadrotor.training.quality_results import (
    Interval,
    PredictorQuality,
    Quality,
    ReconstructionQuality,
)
from faultpath.report.wording import percent, plain, signed

ABSENT = "*Nothing has been measured here: the checkpoint is missing.*"
ZERO_WIND = "zero"


def rows_of(quality: Quality, pool: str) -> list[PredictorQuality]:
    """Return the predictors that were measured on a pool."""
    return [row for row in quality.predictors if row.pool == pool]


def label(row: PredictorQuality) -> str:
    """Return what a predictor is called: its name, and that it is told of no wind."""
    return f"{row.name}, zero wind" if row.wind == ZERO_WIND else row.name


def origin(quality: Quality) -> str:
    """Return what was measured on what."""
    asked = quality.settings
    head = ["Validation windows", "Episodes", "Windows", *asked.level_mean_mps, "Rows, SHA-256"]
    body = [
        [
            f"`{name}`",
            f"{pool.episodes}",
            f"{pool.windows}",
            *(str(count) for count in pool.by_level.values()),
            f"`{pool.rows_sha256[:12]}`",
        ]
        for name, pool in quality.pools.items()
    ]
    means = ", ".join(f"{name} {speed:g}" for name, speed in asked.level_mean_mps.items())
    return "\n".join(
        [
            *_table(head, body),
            "",
            f"{asked.history} intervals of history, {asked.horizon} ahead, {asked.step_s:g} s "
            f"each. {asked.resamples} resamples. Mean winds of the levels, m/s: {means}. "
            f"{len(quality.checkpoints)} checkpoints were measured.",
        ]
    )


def missing(quality: Quality) -> str:
    """Return which checkpoints were not there."""
    if not quality.missing:
        return "Every checkpoint of the catalogue was there."
    names = ", ".join(f"`{name}`" for name in quality.missing)
    return f"**Missing, and left out of every number here:** {names}."


def prediction(quality: Quality, pool: str) -> str:
    """Return the errors of the predictors of a pool under correct calibration."""
    body = [
        [
            f"`{row.name}`" + label(row).removeprefix(row.name),
            *_interval(row.mean.median_m),
            plain(row.mean.p90_m, 3),
            _by_seed(plain(score.median_m.value, 3) for score in row.seeds.values()),
            _by_seed(str(seed) for seed in row.seeds),
        ]
        for row in rows_of(quality, pool)
    ]
    head = ["Predictor", "Median, m", "95 % interval", "90th percentile, m", "Median by seed"]
    return "\n".join(_table([*head, "Seeds"], body))


def prediction_under_error(quality: Quality, pool: str) -> str:
    """Return median and 90th percentile under each calibration error."""
    body = [
        [
            f"`{row.name}`" + label(row).removeprefix(row.name),
            *(f"{plain(u.median_m, 2)} / {plain(u.p90_m, 2)}" for u in row.mean.under_error),
        ]
        for row in rows_of(quality, pool)
    ]
    return "\n".join(_table(["Median / 90th percentile, m", *_errors(quality)], body))


def reconstruction(quality: Quality) -> str:
    """Return the wind errors under correct calibration, over all and by wind level."""
    levels = quality.settings.level_mean_mps
    body = [
        [
            f"`{row.name}`",
            *_interval(row.mean.rmse_mps, 2),
            *(
                plain(row.mean.by_level[level], 2) if level in row.mean.by_level else "–"
                for level in levels
            ),
            _by_seed(plain(score.rmse_mps.value, 2) for score in row.seeds.values()),
            _by_seed(str(seed) for seed in row.seeds),
        ]
        for row in quality.reconstructions
    ]
    head = ["Reconstruction", "RMSE, m/s", "95 % interval", *levels, "RMSE by seed", "Seeds"]
    return "\n".join(_table(head, body))


def reconstruction_under_error(quality: Quality) -> str:
    """Return the wind error, and the mean shift of the vertical wind, by calibration error."""

    def shift(row: ReconstructionQuality) -> list[str]:
        return [
            f"{plain(u.rmse_mps, 2)} / {signed(u.vertical_shift_mps, 2)}"
            for u in row.mean.under_error
        ]

    body = [[f"`{row.name}`", *shift(row)] for row in quality.reconstructions]
    return "\n".join(_table(["RMSE / vertical shift, m/s", *_errors(quality)], body))


def clearance(quality: Quality) -> str:
    """Return the errors of estimated clearance by range and by visibility."""
    found = quality.clearance
    if found is None:
        return ABSENT
    parts = {"everywhere": found["overall"]}
    parts |= {f"{r['low_m']:g} to {r['high_m']:g} m away": r for r in found["by_range"]}
    parts |= found["by_visibility"]
    middle, most = (found["quantiles"].index(q) for q in (0.5, 0.95))
    body = [
        [
            name,
            str(part["count"]),
            *(
                "–" if part["absolute_m"] is None else plain(part["absolute_m"][at], 3)
                for at in (middle, most)
            ),
            "–" if part["signed_m"] is None else signed(part["signed_m"][middle], 3),
            "–" if part["wrong_sign"] is None else percent(part["wrong_sign"]),
        ]
        for name, part in parts.items()
    ]
    head = ["Points", "Count", "Median error, m", "95th percentile, m", "Median signed error, m"]
    table = _table([*head, "Wrong sign, %"], body)
    told = f"{found['images']} images of the {found['library']} library, seed {found['seed']}."
    return "\n".join([*table, "", told])


def weights(quality: Quality) -> str:
    """Return the digest of every checkpoint that was measured."""
    body = [
        [f"`{each.name}`", str(each.seed), f"`{each.weights_sha256[:16]}`"]
        for each in quality.checkpoints
    ]
    return "\n".join(_table(["Model", "Seed", "Weights, SHA-256"], body))


BLOCKS: Mapping[str, Callable[[Quality], str]] = {
    "origin": origin,
    "missing": missing,
    "prediction-nominal": lambda quality: prediction(quality, "nominal"),
    "prediction-wind": lambda quality: prediction(quality, "wind"),
    "calibration-nominal": lambda quality: prediction_under_error(quality, "nominal"),
    "calibration-wind": lambda quality: prediction_under_error(quality, "wind"),
    "reconstruction": reconstruction,
    "calibration-reconstruction": reconstruction_under_error,
    "clearance": clearance,
    "weights": weights,
}
"""What a block of each name holds."""


def _table(head: Sequence[str], body: Iterable[Sequence[str]]) -> list[str]:
    aligned = [":--", *["--:"] * (len(head) - 1)]
    return [f"| {' | '.join(row)} |" for row in (head, aligned, *body)]


def _interval(estimate: Interval, digits: int = 3) -> tuple[str, str]:
    ends = f"[{plain(estimate.low, digits)}, {plain(estimate.high, digits)}]"
    return plain(estimate.value, digits), ends


def _by_seed(values: Iterable[str]) -> str:
    return " / ".join(values) or "–"


def _errors(quality: Quality) -> list[str]:
    return [f"e = {signed(error)}" for error in quality.settings.calibration_errors]
