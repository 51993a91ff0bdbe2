"""NumPy and torch, for tests of what holds on the arrays of both."""

from typing import Any

import numpy as np
import pytest


def to_torch(value: Any) -> Any:
    """Return a tensor; torch is imported here, so that NumPy's cases run without it."""
    import torch

    return torch.asarray(value)


LIBRARIES = pytest.mark.parametrize("to", [np.asarray, to_torch], ids=["numpy", "torch"])
