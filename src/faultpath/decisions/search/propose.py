"""Which faults to try next: CMA-ES, started at the best of some that are spread evenly."""

from collections.abc import Generator, Sequence

import numpy as np
from scipy.stats import qmc

from faultpath.core.errors import UserError
from faultpath.core.streams import generator
from faultpath.core.text import extra
from faultpath.statistics.inputs import Floats

FEWEST = 8
_STEP = 0.2
"""First standard deviation of CMA-ES, as a share of every range."""


def proposals(
    dimensions: int, seed: int, most: int
) -> Generator[list[Floats], Sequence[float], None]:
    """Yield batches of points in the unit cube, `most` points in all; takes the value of each
    point of a batch, of which it looks for the largest.

    The same seed and the same values give the same points. `UserError` without the package
    `cmaes`.
    """
    try:
        # The package has annotations and no marker that says so.
        from cmaes import CMA  # pyright: ignore[reportMissingTypeStubs]
    except ModuleNotFoundError:
        raise UserError(
            f"a search needs the package 'cmaes', which is not installed: {extra('search')}"
        ) from None
    stream = generator("search", "", seed)
    first = min(most, max(FEWEST, most // 3))
    spread = qmc.Halton(dimensions, scramble=False).random(first) + stream.random(dimensions)
    points = list(spread % 1.0)
    values = yield points
    cma = CMA(
        mean=points[int(np.argmax(values))],
        sigma=_STEP,
        bounds=np.tile([0.0, 1.0], (dimensions, 1)),
        seed=int(stream.integers(2**32)),
    )
    left = most - first
    while left > 0:
        points = [cma.ask() for _ in range(min(cma.population_size, left))]
        left -= len(points)
        values = yield points
        if left > 0:
            cma.tell([(point, -value) for point, value in zip(points, values, strict=True)])
