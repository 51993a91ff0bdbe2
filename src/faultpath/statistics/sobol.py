"""Sobol indices of independent groups of numbers: Saltelli's design and SALib's estimators.

The first-order index of a group is the share of the variance that would go on average if the group
were known exactly, the total index what would stay if all others were (Saltelli et al., Computer
Physics Communications 181:259, 2010). Numbers of a group move together, so dependence inside a
group needs no model; groups are independent of each other.
"""

from collections.abc import Sequence
from typing import Any, NamedTuple, cast

import numpy as np

from faultpath.core.errors import UserError
from faultpath.core.text import extra
from faultpath.statistics.inputs import Floats

RESAMPLES = 1000


class Sobol(NamedTuple):
    """Indices `[groups]`, each with the half-width of its interval."""

    first: Floats
    first_width: Floats
    total: Floats
    total_width: Floats


def design(sizes: Sequence[int], points: int, seed: int) -> Floats:
    """Return `[points * (groups + 2), numbers]` in the unit cube; a group has `sizes` numbers.

    For each point: one draw of all, the same with one group after the other drawn anew, and a
    second draw of all. `points` is a power of two. `UserError` without the package SALib.
    """
    sample = _salib()[0]
    return sample(_problem(sizes), points, calc_second_order=False, seed=seed)


def indices(values: Floats, groups: int, level: float, seed: int) -> Sobol | None:
    """Return the indices of `values` `[rows of the design]`, with bootstrap intervals over its
    points; `None` where nothing varies, so that there is no variance to share."""
    drawn = values.reshape(-1, groups + 2)[:, [0, -1]]
    if np.ptp(values) <= 1e-12 * np.abs(values).max() or np.ptp(drawn) == 0.0:
        return None
    analyze = _salib()[1]
    # A seed of 0 would draw from NumPy's global state.
    shares = analyze(
        _problem([1] * groups),
        values,
        calc_second_order=False,
        num_resamples=RESAMPLES,
        conf_level=level,
        seed=seed + 1,
    )
    return Sobol(*(np.asarray(shares[name]) for name in ("S1", "S1_conf", "ST", "ST_conf")))


def _problem(sizes: Sequence[int]) -> dict[str, Any]:
    groups = [f"g{index}" for index, size in enumerate(sizes) for _ in range(size)]
    names = [f"x{index}" for index in range(len(groups))]
    bounds = [[0.0, 1.0]] * len(groups)
    return {"num_vars": len(groups), "names": names, "bounds": bounds, "groups": groups}


def _salib() -> tuple[Any, Any]:
    try:
        # The package has no annotations.
        from SALib.analyze import sobol as analysis  # pyright: ignore
        from SALib.sample import sobol as sampling  # pyright: ignore
    except ModuleNotFoundError as error:
        name = str(error.name).partition(".")[0]
        raise UserError(
            f"a sensitivity analysis needs the package {name!r}, which is not installed: "
            f"{extra('sensitivity')}"
        ) from None
    return cast(Any, sampling).sample, cast(Any, analysis).analyze
