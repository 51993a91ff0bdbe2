"""Tables and pictures of `docs/learning-quality.md`, from what was measured."""

from collections.abc import Callable, Iterable, Mapping
from functools import partial
from pathlib import Path
from typing import Any

from blocks import REFERENCE, Columns, Row, parsed, tabled, told
from learning_figures import PICTURES, ZERO_WIND, rows_of
from pictures import IMAGES

from faultpath.quadrotor.training.quality_results import Quality
from faultpath.record.wording import signed
from faultpath.tables import MISSING

ABSENT = "*Nothing has been measured here: the checkpoint is missing.*"
POOLS = ("nominal", "wind")


def result_path() -> Path:
    """Return where the measurement stands."""
    return REFERENCE / "learning-quality.json"


def read() -> Quality:
    """Return the measurement; `Wrong` when there is none or it is of another version."""
    return parsed(result_path(), Quality, "run tools/learning_quality.py")


def picture(name: str, quality: Quality) -> str:
    """Return the link to a picture where there is one."""
    words, draw = PICTURES[name]
    return ABSENT if draw(quality) is None else f"![{words}]({{images}}/learning-{name}.svg)"


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
    levels = {level: f"{{by_level[{level}]}}" for level in asked.level_mean_mps}
    rows = [{"name": name, **pool.model_dump()} for name, pool in quality.pools.items()]
    counts = {"Episodes": "{episodes}", "Windows": "{windows}"}
    columns = {**counts, **levels, "Rows, SHA-256": "`{rows_sha256:.12}`"}
    means = ", ".join(f"{name} {speed:g}" for name, speed in asked.level_mean_mps.items())
    return (
        f"{tabled('Validation windows', rows, columns, code=True)}\n\n"
        f"{asked.history} intervals of history, {asked.horizon} ahead, {asked.step_s:g} s each. "
        f"{asked.resamples} resamples. Mean winds of the levels, m/s: {means}. "
        f"{len(quality.checkpoints)} checkpoints were measured."
    )


def missing(quality: Quality) -> str:
    """Return which checkpoints were not there."""
    if not quality.missing:
        return "Every checkpoint of the catalogue was there."
    names = ", ".join(f"`{name}`" for name in quality.missing)
    return f"**Missing, and left out of every number here:** {names}."


def _predictors(pool: str, corner: str, columns: Columns, quality: Quality) -> str:
    rows = [
        {"aside": "zero wind" if row.wind == ZERO_WIND else "", **row.model_dump()}
        for row in rows_of(quality, pool)
    ]
    return tabled(corner, rows, columns, code=True)


def prediction(pool: str, quality: Quality) -> str:
    """Return the errors of the predictors of a pool under correct calibration."""
    columns: Columns = {
        "Median, m": "{mean[median_m][value]:3}",
        "95 % interval": "[{mean[median_m][low]:3}, {mean[median_m][high]:3}]",
        "90th percentile, m": "{mean[p90_m]:3}",
        "Median by seed": lambda row: _joined("{median_m[value]:3}", row["seeds"].values()),
        "Seeds": _seeds,
    }
    return _predictors(pool, "Predictor", columns, quality)


def prediction_under_error(pool: str, quality: Quality) -> str:
    """Return median and 90th percentile under each calibration error."""
    columns = _under_errors("{%[median_m]:2} / {%[p90_m]:2}", quality)
    return _predictors(pool, "Median / 90th percentile, m", columns, quality)


def reconstruction(quality: Quality) -> str:
    """Return the wind errors under correct calibration, over all and by wind level."""
    columns: Columns = {
        "RMSE, m/s": "{mean[rmse_mps][value]:2}",
        "95 % interval": "[{mean[rmse_mps][low]:2}, {mean[rmse_mps][high]:2}]",
        **{each: f"{{mean[by_level][{each}]:2}}" for each in quality.settings.level_mean_mps},
        "RMSE by seed": lambda row: _joined("{rmse_mps[value]:2}", row["seeds"].values()),
        "Seeds": _seeds,
    }
    return _reconstructions("Reconstruction", columns, quality)


def reconstruction_under_error(quality: Quality) -> str:
    """Return the wind error, and the mean shift of the vertical wind, by calibration error."""
    columns = _under_errors("{%[rmse_mps]:2} / {%[vertical_shift_mps]:+2}", quality)
    return _reconstructions("RMSE / vertical shift, m/s", columns, quality)


def _reconstructions(corner: str, columns: Columns, quality: Quality) -> str:
    rows = [row.model_dump() for row in quality.reconstructions]
    return tabled(corner, rows, columns, code=True)


def clearance(quality: Quality) -> str:
    """Return the errors of estimated clearance by range and by visibility."""
    found: Any = quality.clearance
    if found is None:
        return ABSENT
    parts = {"everywhere": found["overall"]}
    parts |= {f"{r['low_m']:g} to {r['high_m']:g} m away": r for r in found["by_range"]}
    parts |= found["by_visibility"]
    middle, most = (found["quantiles"].index(q) for q in (0.5, 0.95))
    columns: Columns = {
        "Count": "{count}",
        "Median error, m": f"{{absolute_m[{middle}]:3}}",
        "95th percentile, m": f"{{absolute_m[{most}]:3}}",
        "Median signed error, m": f"{{signed_m[{middle}]:+3}}",
        "Wrong sign, %": "{wrong_sign:%}",
    }
    rows = [{"name": name, **part} for name, part in parts.items()]
    told = f"{found['images']} images of the {found['library']} library, seed {found['seed']}."
    return f"{tabled('Points', rows, columns)}\n\n{told}"


def weights(quality: Quality) -> str:
    """Return the digest of every checkpoint that was measured."""
    rows = [each.model_dump() for each in quality.checkpoints]
    columns: Columns = {"Seed": "{seed}", "Weights, SHA-256": "`{weights_sha256:.16}`"}
    return tabled("Model", rows, columns, code=True)


def _joined(template: str, rows: Iterable[Row]) -> str:
    return " / ".join(told(template, row) for row in rows) or MISSING


def _seeds(row: Row) -> str:
    return " / ".join(map(str, row["seeds"])) or MISSING


def _under_errors(template: str, quality: Quality) -> Columns:
    return {
        f"e = {signed(error)}": template.replace("%", f"mean[under_error][{i}]")
        for i, error in enumerate(quality.settings.calibration_errors)
    }


BLOCKS: Mapping[str, Callable[[Quality], str]] = {
    "origin": origin,
    "missing": missing,
    **{f"prediction-{pool}": partial(prediction, pool) for pool in POOLS},
    **{f"calibration-{pool}": partial(prediction_under_error, pool) for pool in POOLS},
    "reconstruction": reconstruction,
    "calibration-reconstruction": reconstruction_under_error,
    "clearance": clearance,
    "weights": weights,
    **{f"picture-{name}": partial(picture, name) for name in PICTURES},
}
"""What a block of each name holds: a table, or the link to a picture."""

KIND = {name: partial(lambda fill: fill(read()), fill) for name, fill in BLOCKS.items()}
