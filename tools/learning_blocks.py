"""Tables and pictures of `docs/learning-quality.md`, from what was measured."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path

from blocks import REFERENCE, Wrong
from learning_figures import PICTURES, ZERO_WIND, rows_of
from pictures import IMAGES
from pydantic import ValidationError

from faultpath.quadrotor.training.quality_results import (
    Interval,
    PredictorQuality,
    Quality,
    ReconstructionQuality,
)
from faultpath.report.wording import percent, plain, signed
from faultpath.tables import Entry, Line, Table, line
from faultpath.tables.markdown import grid

ABSENT = "*Nothing has been measured here: the checkpoint is missing.*"
PICTURE = "picture-"


def result_path() -> Path:
    """Return where the measurement stands."""
    return REFERENCE / "learning-quality.json"


def read() -> Quality:
    """Return the measurement; `Wrong` when there is none or it is of another version."""
    try:
        return Quality.model_validate_json(result_path().read_bytes())
    except (OSError, ValidationError):
        raise Wrong(
            f"{result_path()} is missing or of another version: run tools/learning_quality.py"
        ) from None


def fill(name: str) -> str:
    """Return the text of a block: a table, or the link to a picture where there is one."""
    quality = read()
    if name in BLOCKS:
        return BLOCKS[name](quality)
    picture = name.removeprefix(PICTURE)
    if picture == name or picture not in PICTURES:
        known = ", ".join([*BLOCKS, *(PICTURE + each for each in PICTURES)])
        raise Wrong(f"learning-quality.md: there is no block '{name}'; choose from {known}")
    words, draw = PICTURES[picture]
    return ABSENT if draw(quality) is None else f"![{words}]({{images}}/learning-{picture}.svg)"


def pictures() -> Mapping[Path, str]:
    """Return the pictures that can be drawn, by their path."""
    quality = read()
    drawn = {name: draw(quality) for name, (_, draw) in PICTURES.items()}
    return {
        IMAGES / f"learning-{name}.svg": f"{markup}\n"
        for name, markup in drawn.items()
        if markup is not None
    }


def origin(quality: Quality) -> str:
    """Return what was measured on what."""
    asked = quality.settings
    columns = ["Episodes", "Windows", *asked.level_mean_mps, "Rows, SHA-256"]
    lines = (
        line(
            name,
            *(str(pool.episodes), str(pool.windows), *map(str, pool.by_level.values())),
            Entry(text=pool.rows_sha256[:12], name=True),
            name=True,
        )
        for name, pool in quality.pools.items()
    )
    means = ", ".join(f"{name} {speed:g}" for name, speed in asked.level_mean_mps.items())
    return "\n".join(
        [
            _table("Validation windows", columns, lines),
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
    lines = (
        _predictor(
            row,
            *_interval(row.mean.median_m),
            plain(row.mean.p90_m, 3),
            _by_seed(plain(score.median_m.value, 3) for score in row.seeds.values()),
            _by_seed(map(str, row.seeds)),
        )
        for row in rows_of(quality, pool)
    )
    columns = ("Median, m", "95 % interval", "90th percentile, m", "Median by seed", "Seeds")
    return _table("Predictor", columns, lines)


def prediction_under_error(quality: Quality, pool: str) -> str:
    """Return median and 90th percentile under each calibration error."""
    lines = (
        _predictor(
            row, *(f"{plain(u.median_m, 2)} / {plain(u.p90_m, 2)}" for u in row.mean.under_error)
        )
        for row in rows_of(quality, pool)
    )
    return _table("Median / 90th percentile, m", _errors(quality), lines)


def reconstruction(quality: Quality) -> str:
    """Return the wind errors under correct calibration, over all and by wind level."""
    levels = quality.settings.level_mean_mps
    lines = (
        line(
            row.name,
            *_interval(row.mean.rmse_mps, 2),
            *(
                plain(row.mean.by_level[level], 2) if level in row.mean.by_level else "–"
                for level in levels
            ),
            _by_seed(plain(score.rmse_mps.value, 2) for score in row.seeds.values()),
            _by_seed(map(str, row.seeds)),
            name=True,
        )
        for row in quality.reconstructions
    )
    columns = ("RMSE, m/s", "95 % interval", *levels, "RMSE by seed", "Seeds")
    return _table("Reconstruction", columns, lines)


def reconstruction_under_error(quality: Quality) -> str:
    """Return the wind error, and the mean shift of the vertical wind, by calibration error."""

    def shift(row: ReconstructionQuality) -> list[str]:
        return [
            f"{plain(u.rmse_mps, 2)} / {signed(u.vertical_shift_mps, 2)}"
            for u in row.mean.under_error
        ]

    lines = (line(row.name, *shift(row), name=True) for row in quality.reconstructions)
    return _table("RMSE / vertical shift, m/s", _errors(quality), lines)


def clearance(quality: Quality) -> str:
    """Return the errors of estimated clearance by range and by visibility."""
    found = quality.clearance
    if found is None:
        return ABSENT
    parts = {"everywhere": found["overall"]}
    parts |= {f"{r['low_m']:g} to {r['high_m']:g} m away": r for r in found["by_range"]}
    parts |= found["by_visibility"]
    middle, most = (found["quantiles"].index(q) for q in (0.5, 0.95))
    lines = (
        line(
            name,
            str(part["count"]),
            *(
                "–" if part["absolute_m"] is None else plain(part["absolute_m"][at], 3)
                for at in (middle, most)
            ),
            "–" if part["signed_m"] is None else signed(part["signed_m"][middle], 3),
            "–" if part["wrong_sign"] is None else percent(part["wrong_sign"]),
        )
        for name, part in parts.items()
    )
    columns = ("Count", "Median error, m", "95th percentile, m", "Median signed error, m")
    table = _table("Points", (*columns, "Wrong sign, %"), lines)
    told = f"{found['images']} images of the {found['library']} library, seed {found['seed']}."
    return f"{table}\n\n{told}"


def weights(quality: Quality) -> str:
    """Return the digest of every checkpoint that was measured."""
    lines = (
        line(
            each.name,
            str(each.seed),
            Entry(text=each.weights_sha256[:16], name=True),
            name=True,
        )
        for each in quality.checkpoints
    )
    return _table("Model", ("Seed", "Weights, SHA-256"), lines)


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


def _table(corner: str, columns: Sequence[str], lines: Iterable[Line]) -> str:
    return grid(Table(corner=corner, columns=tuple(columns), lines=tuple(lines)))


def _predictor(row: PredictorQuality, *entries: str) -> Line:
    aside = "zero wind" if row.wind == ZERO_WIND else ""
    return line(row.name, *entries, name=True, aside=aside)


def _interval(estimate: Interval, digits: int = 3) -> tuple[str, str]:
    ends = f"[{plain(estimate.low, digits)}, {plain(estimate.high, digits)}]"
    return plain(estimate.value, digits), ends


def _by_seed(values: Iterable[str]) -> str:
    return " / ".join(values) or "–"


def _errors(quality: Quality) -> list[str]:
    return [f"e = {signed(error)}" for error in quality.settings.calibration_errors]
