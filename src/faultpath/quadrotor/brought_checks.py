"""What a part that a user brings must be like, so that nothing fails halfway for want of it."""

from collections.abc import Collection, Mapping
from typing import Any

import torch
from torch import Tensor

from faultpath.errors import SystemMistake
from faultpath.quadrotor.interface import quadrotor_interface
from faultpath.quadrotor.planners import Planner, SamplerSettings, Scored
from faultpath.quadrotor.predictors import KinematicIntegrator, Predictor
from faultpath.quadrotor.predictors.places import PLACES, history, predictor_inputs
from faultpath.quadrotor.predictors.rollout import rollout
from faultpath.quadrotor.reconstruction import Reconstruction
from faultpath.quadrotor.state import LANE_MULTIPLE, State
from faultpath.quadrotor.vehicle import GRAVITY_MPS2
from faultpath.text import listed

_STEPS, _CANDIDATES = 3, 8
_CODE = 32
_PAST = 12

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


def check_reads(name: str, part: object) -> None:
    """Raise `SystemMistake` for reads that are none, or where the interface has nothing."""
    if isinstance(part, Predictor):
        _check_places(name, getattr(part, "reads", None))
    elif isinstance(part, Reconstruction):
        _check_ports(name, getattr(part, "reads", None))


def try_out(name: str, part: object, settings: SamplerSettings) -> None:
    """Let a part do on a made-up moment what it will do in flight; `SystemMistake` for what it
    returns in another shape than the loop takes."""
    with torch.inference_mode():
        if isinstance(part, Predictor):
            _try_predictor(name, part)
        elif isinstance(part, Reconstruction):
            _try_reconstruction(name, part)
        elif isinstance(part, Planner):
            _try_planner(name, part, settings)


def _check_places(name: str, reads: object) -> None:
    known = "; ".join(f"{place} ({', '.join(channels)})" for place, channels in PLACES.items())
    places = _collection(name, reads, "the names of places")
    for place in places:
        if place not in PLACES:
            raise SystemMistake(
                f"{name} reads at the place {place!r}, which predictors do not have: "
                f"choose from {known}"
            )
    for needed in ("initial_state", "trim"):
        if needed not in places:
            raise SystemMistake(
                f"{name} does not read at {needed!r}, which every predictor does: add it to reads"
            )
    if ("history" in places) != ("latent" in places):
        raise SystemMistake(
            f"{name} reads at one of 'history' and 'latent': name both, for the first feeds "
            "encode(), and what that returns arrives at the second"
        )


def _check_ports(name: str, reads: object) -> None:
    interface = quadrotor_interface()
    known = {
        (channel.name, consumer.partition(".")[2])
        for channel in interface.channels
        for consumer in channel.consumers
        if consumer.startswith("reconstruction.")
    }
    reads = _collection(name, reads, "pairs of a channel and a place")
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
                f"{name} reads at {place!r} and not {channel} there: a fault strikes a place "
                f"whole, so add ({channel!r}, {place!r}) to reads, used or not"
            )


def _collection(name: str, reads: object, of: str) -> Collection[Any]:
    if not isinstance(reads, set | frozenset | tuple | list) or not reads:
        raise SystemMistake(f"{name} has the reads {reads!r}: set it to a frozenset of {of}")
    return reads


def _try_predictor(name: str, predictor: Predictor) -> None:
    lanes = 2

    def now(channel: str, place: str) -> Tensor:
        if channel == "history_code":
            assert code is not None
            return code
        return _spread(_READINGS[channel], lanes)

    def past(channel: str, place: str) -> Tensor:
        value = now(channel, place)
        if channel in ("mass", "thrust_scale"):
            return value
        return value[..., None, :].expand(*value.shape[:-1], _PAST, lanes).contiguous()

    code = None
    if "history" in predictor.reads:
        code = predictor.encode(history(predictor.reads, past))
        _check(name, "encode()", code, _CODE, lanes)
    inputs = predictor_inputs(predictor.reads, now)
    memory = predictor.begin(inputs)
    state = inputs.state
    hover = _spread(_READINGS["action"], lanes, _CANDIDATES)
    for _ in range(_STEPS):
        answer: Any = predictor.step(state, hover.clone(), memory)
        if not isinstance(answer, tuple) or len(answer) != 2 or not isinstance(answer[0], State):
            raise SystemMistake(
                f"{name}: step() returned {_shown(answer)}: it returns a State and the memory"
            )
        state, memory = answer
        for part in ("position", "velocity", "rotation", "rate"):
            axes = (3, 3) if part == "rotation" else (3,)
            value = getattr(state, part)
            _check(
                name, f"{part} of the state that step() returns", value, *axes, lanes, _CANDIDATES
            )


def _try_reconstruction(name: str, reconstruction: Reconstruction) -> None:
    def delivered() -> dict[tuple[str, str], Tensor]:
        return {
            read: _spread(_READINGS[read[0]], LANE_MULTIPLE).double()
            for read in reconstruction.reads
        }

    memory = reconstruction.begin(delivered())
    for _ in range(_STEPS):
        memory = reconstruction.update(memory, delivered())
        wind: Any = reconstruction.wind(memory)
        _check(name, "wind()", wind, 3, LANE_MULTIPLE, kinds=(torch.float32, torch.float64))


def _try_planner(name: str, planner: Planner, settings: SamplerSettings) -> None:
    mine: Any = getattr(planner, "sampler", None)
    for what in ("horizon", "candidates"):
        asked, has = getattr(settings, what), getattr(getattr(mine, "settings", None), what, None)
        if has != asked:
            raise SystemMistake(
                f"{name}: the sampler's {what} is {has}, and the options ask for {asked}: build "
                "it with that, or choose the option that it has"
            )
    predictor = KinematicIntegrator(wind=False)
    scenes, horizon, candidates = 1, settings.horizon, settings.candidates
    reads = predictor.reads
    inputs = predictor_inputs(reads, lambda channel, _: _spread(_READINGS[channel], scenes))
    hover = torch.full((scenes,), GRAVITY_MPS2)
    search = planner.init(planner.initial_plan(hover), hover)
    for iteration in range(planner.iterations):
        commands: Any = planner.propose(search, planner.noise(["trial/000"], 0, 0, iteration))
        _check(name, "propose()", commands, horizon, 4, scenes, candidates)
        flown = rollout(predictor, inputs, commands)
        clear = torch.ones(scenes, horizon, candidates)
        search = planner.update(
            search, Scored(flown, commands, clear, torch.zeros(3, scenes), search.hover)
        )
        plan: Any = getattr(search, "plan", None)
        _check(name, "the plan of what update() returns", plan, horizon, 4, scenes)


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
    said = f"{name}: {what} is"
    want = f"a tensor {list(shape)} of {' or '.join(map(_plain, kinds))}"
    if not isinstance(value, Tensor):
        raise SystemMistake(f"{said} {_shown(value)}: it must be {want}")
    if tuple(value.shape) != shape or value.dtype not in kinds:
        raise SystemMistake(
            f"{said} a tensor {list(value.shape)} of {_plain(value.dtype)}: it must be {want}"
        )
    if not bool(value.isfinite().all()):
        raise SystemMistake(f"{said} NaN or infinite in slow flight: it must be finite")


def _plain(kind: torch.dtype) -> str:
    return str(kind).removeprefix("torch.")


def _shown(value: object) -> str:
    return f"a {type(value).__name__}"
