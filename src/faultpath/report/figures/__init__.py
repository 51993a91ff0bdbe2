"""Pictures as pure functions: data in, SVG markup out."""

from faultpath.report.figures.effects import EffectRow, effect_rows, forest, secondary_panel
from faultpath.report.figures.frequency import frequency_panel, shared_range
from faultpath.report.figures.outcomes import outcome_bars
from faultpath.report.figures.pairs import pair_grid, pair_key

__all__ = [
    "EffectRow",
    "effect_rows",
    "forest",
    "frequency_panel",
    "outcome_bars",
    "pair_grid",
    "pair_key",
    "secondary_panel",
    "shared_range",
]
