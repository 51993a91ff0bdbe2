"""For a package that fits its own modules: the loop over epochs, weights and their cards."""

from faultpath.learning.loop import FitProgress, FitTask, Journal, minibatches, run
from faultpath.learning.model_card import (
    Card,
    Schedule,
    encoded,
    fill,
    parameter_count,
    read_card,
    read_note,
    read_tensors,
    save,
    weights_sha256,
)
from faultpath.learning.windows import validates, window_taps

__all__ = [
    "Card",
    "FitProgress",
    "FitTask",
    "Journal",
    "Schedule",
    "encoded",
    "fill",
    "minibatches",
    "parameter_count",
    "read_card",
    "read_note",
    "read_tensors",
    "run",
    "save",
    "validates",
    "weights_sha256",
    "window_taps",
]
