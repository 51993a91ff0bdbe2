"""Outcome arrays in, estimates and intervals out; no plots and no files."""

from faultpath.statistics.estimate import (
    SCENES,
    SCENES_AND_SEEDS,
    BreakEven,
    Direction,
    DirectionShares,
    Discordant,
    Estimate,
    Reversal,
    SeedCounts,
    TestResult,
)

__all__ = [
    "SCENES",
    "SCENES_AND_SEEDS",
    "BreakEven",
    "Direction",
    "DirectionShares",
    "Discordant",
    "Estimate",
    "Reversal",
    "SeedCounts",
    "TestResult",
]
