"""The network of a fit and its optimiser."""

from __future__ import annotations

import copy
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from faultpath.errors import UserError
from faultpath.repairs.code import name_of
from faultpath.repairs.record import Schedule

if TYPE_CHECKING:
    from torch import nn


def fresh(module: nn.Module | Callable[[], nn.Module]) -> nn.Module:
    """Return a network of the fit's own: a copy of the module, or what the factory makes."""
    from torch import nn

    if isinstance(module, nn.Module):
        return copy.deepcopy(module)
    made = module()
    if not isinstance(made, nn.Module):
        raise UserError(f"fit: {name_of(module)} returned a {name_of(made)}, no torch module")
    return made


def adam(net: nn.Module, schedule: Schedule) -> Any:
    """Return the optimiser of a schedule, for what of the network may change."""
    from torch.optim import Adam, AdamW

    fitted = [parameter for parameter in net.parameters() if parameter.requires_grad]
    if not fitted:
        raise UserError(f"fit: {name_of(net)} has no parameters to fit")
    if schedule.optimiser == "adam":
        return Adam(fitted, lr=schedule.learning_rate)
    return AdamW(fitted, lr=schedule.learning_rate, weight_decay=schedule.weight_decay)
