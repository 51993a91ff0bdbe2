"""The test of scene differences by flipping their signs: exact, and without random draws.

Where the variants are exchangeable within a scene, each difference is as likely as its negative.
Given their sizes, their sum is then a sum of independent signs, whose law is a product of as many
terms.
"""

import numpy as np

from faultpath.statistics.inputs import Floats

_HALVINGS = 12
"""Halvings tried of the unit in which scenes differ: means over seeds, and weighted sums."""
_SLACK = 1e-6


def p_value(values: Floats, n_seeds: int) -> float:
    """Return the two-sided p of ``values`` [scenes], which differ by parts of ``1 / n_seeds``.

    The chance that the sum of the values with random signs lies as far from 0 as theirs.
    """
    for halving in range(_HALVINGS):
        parts = n_seeds * 2.0**halving
        sums = np.rint(values * parts).astype(np.int64)
        if (np.abs(values * parts - sums) < _SLACK * parts).all():
            break
    else:
        raise ValueError(f"scene differences are no parts of 1 / {n_seeds}")
    total, seen = int(np.abs(sums).sum()), abs(int(sums.sum()))
    law = np.zeros(total + 1)  # of the sum of those that are positive
    law[0] = 1.0
    for size in np.abs(sums[sums != 0]).tolist():
        law *= 0.5
        law[size:] += law[:-size].copy()
    return min(1.0, 2.0 * float(law[(total + seen) // 2 :].sum())) if seen else 1.0


def p_values(values: Floats, counts: Floats) -> Floats:
    """Return [audits]: the same, for ``counts`` [audits, values] of evenly spaced ``values``.

    By the characteristic function, a product of cosines: fit for simulations, good to 1e-12.
    """
    step = float(np.diff(values).min())
    sizes = np.rint(np.abs(values) / step)
    seen = np.abs(counts @ np.rint(values / step))
    # A law of independent signs has next to nothing beyond eight of its standard deviations.
    spread = float(np.sqrt((counts @ sizes**2).max(initial=0.0)))
    around = 2 * int(max(seen.max(initial=0.0), 8.0 * spread)) + 3
    angles = np.arange(around) * (2.0 * np.pi / around)
    cosines = np.cos(sizes[:, np.newaxis] * angles)
    logs = np.log(np.maximum(np.abs(cosines), np.finfo(np.float64).tiny))
    odd = (counts @ (cosines < 0.0)) % 2.0
    wave = np.exp(counts @ logs) * (1.0 - 2.0 * odd)
    law = np.fft.fft(wave, axis=1).real / around  # of the sum, negative ones from behind
    place = np.arange(around)
    far = np.minimum(place, around - place)
    beyond = np.where(far >= seen[:, np.newaxis], law, 0.0).sum(axis=1)
    return np.clip(beyond, 0.0, 1.0)
