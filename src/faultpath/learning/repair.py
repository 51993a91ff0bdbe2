"""Repairs of the inputs of a module: uncertainty training, withholding, reconstruction."""

from collections.abc import Collection, Iterable, Iterator, Mapping
from itertools import groupby
from math import sqrt
from typing import Literal, TypeAlias

import numpy as np

from faultpath.core.arrays import Constant
from faultpath.core.errors import UserError
from faultpath.core.results import Frozen
from faultpath.core.text import listed
from faultpath.faults import ALL, Bias, Erase, Fault, Noise, parse_fault, resolve
from faultpath.interface import Interface

Persistence: TypeAlias = Literal["window", "step"] | float
"""Persistence of a random error: one draw a window, one a step, or a time constant in seconds."""


class Repair(Frozen):
    """A change to a fit that its baseline does not have (paper, "Propose Repairs, Then Audit").

    Made by `uncertainty_training`, `withholding` and `reconstruction`.
    """

    kind: Literal["uncertainty_training", "withholding", "reconstruction"]
    faults: tuple[Fault | str, ...] = ()
    """Faults that the taps apply to every window; text as an audit's `--fault` takes it."""
    channel: str | None = None
    """Channel that a reconstruction estimates."""

    @property
    def words(self) -> str:
        """Description of the repair."""
        if self.kind == "reconstruction":
            return f"reconstruction of {self.channel}"
        descriptions: list[str] = []
        for fault in self.faults:
            text = fault if isinstance(fault, str) else fault.describe()
            if isinstance(fault, Fault) and fault.loading != 1.0:
                text += f", with a loading of {fault.loading:g} on {fault.drawn_from}"
            descriptions.append(text)
        return f"{self.kind.replace('_', ' ')}: {'; '.join(descriptions)}"

    def against(self, interface: Interface, dt_s: float, present: Collection[str]) -> "Repair":
        """Return the repair with all readers spelled out, of those that are `present`.

        Raises `UserError` where it does not fit, or reaches none of them.
        """
        if self.channel is not None:
            interface.channel(self.channel)
        if self.kind == "withholding":
            for fault in self.faults:
                _check_value(fault, interface)
        reached: list[Fault] = []
        for faults in parsed_by_cause(self.faults, interface, dt_s):
            reached += resolve(faults, interface, present)
        return self.model_copy(update={"faults": tuple(reached)})


def _check_value(fault: Fault | str, interface: Interface) -> None:
    """Raise `UserError` unless a neutral value has the reading's shape.

    In a fit it could be broadcast, but a loop has no reading to take the shape from.
    """
    if isinstance(fault, str) or not isinstance(fault.intervention, Erase):
        return
    shape = interface.source(interface.channel(fault.channel).sources[0]).shape
    value = fault.intervention.default
    if value is not None and np.shape(value) != shape:
        raise UserError(
            f"withholding '{fault.channel}': its reading has the shape {list(shape)}, "
            f"and the value {list(np.shape(value))}: give one number for each"
        )


def parsed_by_cause(
    faults: Iterable[Fault | str], interface: Interface, dt_s: float
) -> Iterator[tuple[Fault, ...]]:
    """Yield the faults of each text, parsed like `--fault`, and adjacent faults of one cause.

    Raises `UserError` for a fault that does not fit.
    """
    for cause, group in groupby(faults, lambda f: None if isinstance(f, str) else f.drawn_from):
        if cause is None:
            for text in group:
                yield parse_fault(str(text), interface, {}, dt_s)
        else:
            yield tuple(fault for fault in group if isinstance(fault, Fault))


def withheld_faults(repairs: Iterable[Repair]) -> tuple[Fault | str, ...]:
    """Return the faults that withhold a channel, which stay at the taps after the fit."""
    return tuple(
        fault for repair in repairs if repair.kind == "withholding" for fault in repair.faults
    )


def uncertainty_training(*q_eps: Fault | str | tuple[Fault, ...]) -> Repair:
    """Return the repair that draws new errors for each window and epoch of a fit.

    Samples and targets stay as they are (paper, Eq. 1). `q_eps` are the faults of an audit, as
    objects or as text: `"mass:uniform_scale=0.2"` is the paper's. Errors drawn once a scene are
    drawn once a window. Onset and drift count a window's own steps from 0. `errors` makes the usual
    Gaussian ones.
    """
    if not q_eps:
        raise UserError("uncertainty_training: name at least one error, or leave the repair out")
    faults = (fault for q in q_eps for fault in (q if isinstance(q, tuple) else (q,)))
    return Repair(kind="uncertainty_training", faults=tuple(faults))


def errors(
    magnitude: Mapping[str, float],
    persistence: Persistence = "window",
    dependence: float | Mapping[str, float] = 0.0,
    relative: bool = True,
) -> tuple[Fault, ...]:
    """Return Gaussian errors of several channels, for a fit or for an audit.

    Args:
        magnitude: Channel to the standard deviation of its error, as a fraction of the reading or,
            unless `relative`, in its unit.
        persistence: `"window"` for one draw a window (in an audit: a scene), `"step"` for one a
            step, or the time constant in seconds of an Ornstein-Uhlenbeck process.
        dependence: Correlation between the errors of any two channels, from 0 to 1; or channel to
            its loading from -1 to 1, of which a correlation is the product of two.

    Raises `UserError` for a number out of its range and a loading of another channel.
    """
    if isinstance(dependence, Mapping):
        loadings = dependence
    elif 0 <= dependence <= 1:
        loadings = dict.fromkeys(magnitude, sqrt(dependence))
    else:
        raise UserError(f"errors: a dependence of {dependence} is not from 0 to 1")
    if set(loadings) != set(magnitude):
        raise UserError(
            f"errors: dependence has loadings of {listed(loadings)}, and magnitude is of "
            f"{listed(magnitude)}: name the same channels"
        )
    faults: list[Fault] = []
    cause = f"q_eps of {listed(magnitude)}"
    for channel, std in magnitude.items():
        loading = loadings[channel]
        if not (std >= 0 and -1 <= loading <= 1):
            raise UserError(
                f"errors: channel '{channel}' has magnitude {std} and loading {loading}: the first "
                "must not be negative, the second is from -1 to 1"
            )
        if persistence == "step":
            intervention: Bias | Noise = Noise(std=std, relative=relative)
        elif persistence == "window":
            intervention = Bias(std=std, relative=relative)
        elif isinstance(persistence, str) or not persistence > 0:
            raise UserError(
                f"errors: a persistence of {persistence!r} is none: give 'window', 'step' or "
                "seconds"
            )
        else:
            intervention = Bias(std=std, relative=relative, time_constant_s=persistence)
        faults.append(
            Fault(channel=channel, intervention=intervention, cause=cause, loading=loading)
        )
    if not faults:
        raise UserError("errors: magnitude names no channel")
    return tuple(faults)


def withholding(
    channel: str, readers: str | Iterable[str] = ALL, value: Constant | None = None
) -> Repair:
    """Return the repair in which readers get a channel's neutral value instead of the channel.

    In a fit the taps replace every reading by it; in a loop `withheld` supplies it to a module that
    no longer reads the channel.

    Args:
        channel: Channel to withhold.
        readers: Modules or `module.place`; all by default.
        value: In the reading's unit and shape; default the channel's erasure default.
    """
    names = (readers,) if isinstance(readers, str) else tuple(readers)
    fault = Fault(channel=channel, intervention=Erase(default=value), readers=names)
    return Repair(kind="withholding", faults=(fault,))


def reconstruction(channel: str) -> Repair:
    """Return the repair whose fit learns to estimate a channel from its module's inputs.

    The target of each window is the channel's correct reading; a further repair may perturb the
    inputs. Downstream modules stay as they are.
    """
    return Repair(kind="reconstruction", channel=channel)
