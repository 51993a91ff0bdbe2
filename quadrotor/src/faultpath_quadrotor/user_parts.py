"""Parts of the user's own, named as `my_model.py:create`: `Part` says which.

`create(seed)` builds one; `seed` is that of the trained model, and `None` where only what it is and
what it reads will be looked at, so that weights may be blank. For a plant it returns the class.
A part is tried on a made-up moment before it runs, so that nothing fails halfway for want of it.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import torch
from torch import Tensor, nn

from faultpath.plugin.system import (
    SystemMistake,
    SystemSpec,
    explained,
    factory_root,
    listed,
    load_parts,
    located,
)
from faultpath_quadrotor.device import CPU
from faultpath_quadrotor.estimators import Estimator
from faultpath_quadrotor.estimators.protocol import SOURCES
from faultpath_quadrotor.interface import quadrotor_interface
from faultpath_quadrotor.planners import Planner, SamplerSettings, Scored
from faultpath_quadrotor.plant import Plant
from faultpath_quadrotor.predictors import KinematicIntegrator, Predictor
from faultpath_quadrotor.predictors.base import check_places, history, predictor_inputs
from faultpath_quadrotor.predictors.module import STEPS as HISTORY
from faultpath_quadrotor.predictors.rollout import rollout
from faultpath_quadrotor.predictors.true_parameter import CODE
from faultpath_quadrotor.reconstruction import Reconstruction
from faultpath_quadrotor.state import LANE_MULTIPLE, State
from faultpath_quadrotor.vehicle import GRAVITY_MPS2

Part = Predictor | Reconstruction | Planner | Estimator | type[Plant]
KINDS = (Predictor, Reconstruction, Planner, Estimator)

_STEPS, _CANDIDATES = 3, 8
_READINGS: Mapping[str, Tensor] = {
    "mass": torch.tensor(1.0),
    "thrust_scale": torch.tensor(1.0),
    "position": torch.tensor([0.0, 0.0, 1.5]),
    "velocity": torch.tensor([1.0, 0.5, 0.0]),
    "attitude": torch.eye(3),
    "body_rate": torch.zeros(3),
    "action": torch.tensor([GRAVITY_MPS2, 0.0, 0.0, 0.0]),
    "wind": torch.zeros(3),
    "physics": torch.ones(9),
}
"""A vehicle in slow flight, by channel; what each holds at one moment."""


@dataclass(frozen=True)
class UserPart:
    """A part that the user named."""

    name: str
    blank: Any
    """A `Part`, from its factory without a seed."""
    _folder: Path
    _create: Callable[[int | None], Part]
    _settings: SamplerSettings
    _tried: set[int] = field(default_factory=set[int])

    @property
    def reads(self) -> frozenset[Any]:
        """Where it reads, for a part that says so itself."""
        return frozenset(getattr(self.blank, "reads", ()))

    @property
    def description(self) -> str:
        """Its class and its name, in words."""
        return f"{type(self.blank).__name__} of {self.name}"

    @property
    def data_files(self) -> Sequence[Path]:
        """The files that decide what it does beside its code; relative ones lie beside that."""
        files = getattr(self.blank, "data_files", None) or ()
        return tuple(self._folder / file for file in files)

    def load(self, seed: int | None, device: torch.device = CPU) -> Any:
        """Return a new one for a treatment of this seed; the first one of a seed is tried out.

        Raises `SystemMistake` for one that is not like its blank, or that fails when it is tried.
        """
        if seed is None:
            return self.blank
        with device:
            part: Any = _built(self.name, self._create, seed)
            reads = frozenset(getattr(part, "reads", ()))
            if type(part) is not type(self.blank) or reads != self.reads:
                raise SystemMistake(
                    f"{self.name} returned a part for seed {seed} that is of another class or "
                    "reads elsewhere than the one for None: let seeds differ in weights only"
                )
            if seed not in self._tried:
                with torch.inference_mode():
                    _explaining(lambda: _try(self.name, part, self._settings))
                self._tried.add(seed)
        return part


def load_user_parts(names: Sequence[str], settings: SamplerSettings) -> dict[str, UserPart]:
    """Load the parts of these names, for a planner of these settings.

    `UserError` for a name that leads nowhere, `SystemMistake` for what is no part, or reads where
    nothing is.
    """
    created = _explaining(lambda: load_parts(names, (*KINDS, Plant)))
    return {name: _loaded(name, create, settings) for name, create in created.items()}


def _loaded(name: str, create: Callable[..., Any], settings: SamplerSettings) -> UserPart:
    part: Any = _built(name, create, None)
    if isinstance(part, Predictor):
        check_places(name, part.reads)
    elif isinstance(part, Reconstruction):
        _check_ports(name, part.reads)
    elif isinstance(part, Estimator) and (odd := set(part.writes) - set(SOURCES.values())):
        raise SystemMistake(
            f"{name} writes {min(odd)!r}, which is no source of an estimator: "
            f"choose from {listed(SOURCES.values())}"
        )
    members = () if isinstance(part, type) else (part, *vars(part).values())
    trained = (isinstance(p, nn.Module) and next(p.parameters(), None) is not None for p in members)
    if getattr(part, "data_files", None) is None and any(trained):
        raise SystemMistake(
            f"{name} returned a {type(part).__name__} that holds trained weights and does not say "
            "where they come from: set its data_files to the files that they are read from, for "
            "every seed, or to () where no file is read"
        )
    folder = (factory_root(SystemSpec(name=name)).path or Path("here")).parent
    return UserPart(name, part, folder, create, settings)


def _built(name: str, create: Callable[..., Any], seed: int | None) -> Part:
    try:
        inspect.signature(create).bind(0)
    except (TypeError, ValueError):
        raise SystemMistake(
            f"{name} cannot be called with a seed alone: let it take just that"
        ) from None
    part = _explaining(lambda: create(seed))
    plant = isinstance(part, type) and issubclass(part, Plant)
    if not plant and not isinstance(part, KINDS):
        kinds = " or a ".join(kind.__name__ for kind in KINDS)
        raise SystemMistake(
            f"{name} returned a {type(part).__name__} for seed {seed}: it must return a {kinds}, "
            "derived from the class of that name, or a class derived from Plant"
        )
    return part


def _explaining(act: Callable[[], Any]) -> Any:
    """Do what runs the user's code; what is wrong with it comes as one sentence, with its line."""
    try:
        return act()
    except Exception as error:
        mistake = explained(error)
        if mistake is None:
            raise
        raise located(mistake) from error


def _check_ports(name: str, reads: Collection[tuple[str, str]]) -> None:
    known = {
        (channel.name, reader.partition(".")[2])
        for channel in quadrotor_interface().channels
        for reader in channel.readers
        if reader.startswith("reconstruction.")
    }
    for read in reads:
        if read not in known:
            raise SystemMistake(
                f"{name} reads {read!r}, a channel and place that reconstructions do not have: "
                f"choose from {listed(f'{channel} at {place}' for channel, place in known)}"
            )
    places = {place for _, place in reads}
    for channel, place in sorted(known - set(reads)):
        if place in places:
            raise SystemMistake(
                f"{name} reads at {place!r} and not {channel} there: a fault reaches a place "
                f"whole, so add ({channel!r}, {place!r}) to reads, used or not"
            )


def _try(name: str, part: Any, settings: SamplerSettings) -> None:
    """Let a part do on a made-up moment what it will do in flight; `SystemMistake` for what it
    returns in another shape than the loop takes."""
    if isinstance(part, Predictor):
        _try_predictor(name, part)
    elif isinstance(part, Reconstruction):
        _try_reconstruction(name, part)
    elif isinstance(part, Planner):
        _try_planner(name, part, settings)


def _try_predictor(name: str, predictor: Predictor) -> None:
    lanes = 2
    code: Any = None

    def now(channel: str, place: str) -> Tensor:
        return code if channel == "history_code" else _spread(_READINGS[channel], lanes)

    def past(channel: str, place: str) -> Tensor:
        value = now(channel, place)
        if channel in ("mass", "thrust_scale"):
            return value
        return value[..., None, :].expand(*value.shape[:-1], HISTORY, lanes).contiguous()

    if "history" in predictor.reads:
        code = predictor.encode(history(predictor.reads, past))
        _check(name, "encode()", code, CODE, lanes)
    inputs = predictor_inputs(predictor.reads, now)
    memory, state = predictor.begin(inputs), inputs.state
    hover = _spread(_READINGS["action"], lanes, _CANDIDATES)
    for _ in range(_STEPS):
        answer: Any = predictor.step(state, hover.clone(), memory)
        if not isinstance(answer, tuple) or len(answer) != 2 or not isinstance(answer[0], State):
            kind = type(answer).__name__
            raise SystemMistake(
                f"{name}: step() returned a {kind}: it returns a State and the memory"
            )
        state, memory = answer
        for part, value in vars(state).items():
            axes = (3, 3) if part == "rotation" else (3,)
            what = f"{part} of the state that step() returns"
            _check(name, what, value, *axes, lanes, _CANDIDATES)


def _try_reconstruction(name: str, reconstruction: Reconstruction) -> None:
    readings = {
        read: _spread(_READINGS[read[0]], LANE_MULTIPLE).double() for read in reconstruction.reads
    }
    memory = reconstruction.begin(dict(readings))
    for _ in range(_STEPS):
        memory = reconstruction.update(memory, dict(readings))
        wind: Any = reconstruction.wind(memory)
        _check(name, "wind()", wind, 3, LANE_MULTIPLE, kinds=(torch.float32, torch.float64))


def _try_planner(name: str, planner: Planner, settings: SamplerSettings) -> None:
    mine: Any = getattr(getattr(planner, "sampler", None), "settings", None)
    for what in ("horizon", "candidates"):
        option, has = getattr(settings, what), getattr(mine, what, None)
        if has != option:
            raise SystemMistake(
                f"{name}: the sampler's {what} is {has}, and the options ask for {option}: build "
                "it with that, or choose the option that it has"
            )
    predictor = KinematicIntegrator(wind=False)
    inputs = predictor_inputs(predictor.reads, lambda channel, _: _spread(_READINGS[channel], 1))
    hover = torch.full((1,), GRAVITY_MPS2)
    search = planner.init(planner.initial_plan(hover), hover)
    clear = torch.ones(1, settings.horizon, settings.candidates)
    for iteration in range(planner.iterations):
        commands: Any = planner.propose(search, planner.noise(["trial/000"], 0, 0, iteration))
        _check(name, "propose()", commands, settings.horizon, 4, 1, settings.candidates)
        flown = rollout(predictor, inputs, commands)
        scored = Scored(flown, commands, clear, torch.zeros(3, 1), search.hover)
        search = planner.update(search, scored)
        plan: Any = getattr(search, "plan", None)
        _check(name, "the plan of what update() returns", plan, settings.horizon, 4, 1)


def _spread(value: Tensor, *lanes: int) -> Tensor:
    shaped = value[(..., *(None for _ in lanes))].expand(*value.shape, *lanes)
    return shaped.contiguous().to(torch.get_default_device())


def _check(
    name: str,
    what: str,
    value: object,
    *shape: int,
    kinds: Collection[torch.dtype] = (torch.float32,),
) -> None:
    names = [str(kind).removeprefix("torch.") for kind in (*kinds, getattr(value, "dtype", None))]
    want = f"a tensor {list(shape)} of {' or '.join(names[:-1])}"
    if not isinstance(value, Tensor):
        raise SystemMistake(f"{name}: {what} is a {type(value).__name__}: it must be {want}")
    if tuple(value.shape) != shape or value.dtype not in kinds:
        raise SystemMistake(
            f"{name}: {what} is a tensor {list(value.shape)} of {names[-1]}: it must be {want}"
        )
    if not bool(value.isfinite().all()):
        raise SystemMistake(f"{name}: {what} is NaN or infinite in slow flight: it must be finite")
