"""A cart's interface, windows of it, and small networks to fit."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import torch
from torch import nn

from faultpath.interface import read_interface
from faultpath.learning import Schedule, Windows

DT_S = 0.1
INTERFACE = read_interface("""
name: cart
sources:
- {name: gain_estimate, unit: '1', provenance: estimated}
- {name: speedometer, unit: m/s, provenance: measured}
- {name: compass, unit: '1', shape: [3], provenance: measured}
- {name: true_slope, unit: m/s^2, provenance: privileged}
channels:
- name: gain
  sources: [gain_estimate]
  readers: [observer.model, observer.scale, controller.inverse]
  erasure_default: 1.0
- {name: velocity, sources: [speedometer], readers: [observer.difference, controller.feedback]}
- {name: heading, sources: [compass], readers: [pilot.course], erasure_default: 0.5}
- {name: slope, sources: [true_slope], readers: [controller.feedforward]}
""")
SHORT = Schedule(epochs=2, batch_size=16)


def windows(n: int = 60, steps: int | None = 4, **changes: Any) -> Windows:
    """Windows of the observer, whose target is the slope."""
    draw = np.random.default_rng(3)
    laid = (n,) if steps is None else (n, steps)
    gain = draw.uniform(0.6, 1.4, n).astype(np.float32)
    velocity = draw.normal(size=laid).astype(np.float32)
    slope = (gain * (velocity if steps is None else velocity[:, -1])).astype(np.float32)
    given: dict[str, Any] = {
        "interface": INTERFACE,
        "reader": "observer",
        "readings": {"gain": gain, "velocity": velocity},
        "targets": slope,
        "dt_s": DT_S,
    }
    return Windows(**(given | changes))


class Net(nn.Module):
    """Slope from gain and velocity."""

    def __init__(self, width: int = 8, activation: type[nn.Module] = nn.ReLU) -> None:
        super().__init__()
        self.first, self.last = nn.Linear(8, width), nn.Linear(width, 1)
        self.activation = activation()

    def forward(self, inputs: Mapping[Any, torch.Tensor]) -> torch.Tensor:
        seen = torch.cat([inputs["velocity", "difference"], inputs["gain", "model"]], dim=1)
        return self.last(self.activation(self.first(seen)))[:, 0]


class Spy(nn.Module):
    """Notes what it gets while it is trained."""

    def __init__(self) -> None:
        super().__init__()
        self.weight = nn.Parameter(torch.ones(1))

    def forward(self, inputs: Mapping[Any, torch.Tensor]) -> torch.Tensor:
        if self.training:
            SEEN.append(dict(inputs))
        return self.weight * inputs["velocity", "difference"][:, -1]


SEEN: list[dict[Any, torch.Tensor]] = []
