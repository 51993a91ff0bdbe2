"""Between the two batch axes: taps have scenes first, arithmetic has lanes last."""

import torch
from torch import Tensor

from faultpath.loop import Batch, Inputs, Port
from faultpath.quadrotor.predictors.places import Take
from faultpath.quadrotor.state import padded_lanes


def lanes_of(batch: Batch, device: torch.device) -> Tensor:
    """Return the scene of each lane of a batch, long `[L]`; the last lanes only fill it up."""
    return padded_lanes(len(batch.scenes)).to(device)


def scenes_first(value: Tensor, count: int) -> Tensor:
    """Turn `[..., L]` lanes into `[B, ...]` scenes."""
    return value[..., :count].movedim(-1, 0)


def lanes_last(value: Tensor, lanes: Tensor) -> Tensor:
    """Turn `[B, ...]` scenes into contiguous `[..., L]` lanes."""
    return value.movedim(0, -1)[..., lanes]


def taking(inputs: Inputs, lanes: Tensor) -> Take:
    """Return what gives a predictor the readings of a step, lanes last, single precision."""

    def take(channel: str, place: str) -> Tensor:
        return lanes_last(inputs[Port(channel, place)], lanes).float()

    return take
