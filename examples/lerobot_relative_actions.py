"""LeRobot's relative actions: the policy and the conversion read one calibration of the joints.

A policy trained on relative actions says how far each joint is to move. LeRobot keeps the state
that it saw (`RelativeActionsProcessorStep`) and adds it back (`AbsoluteActionsProcessorStep`): the
state has two readers. An arm of three joints is to reach a pose. Baseline `encoders`: both read the
encoders. Repair `camera`: the policy takes its angles from a camera, which no error of the encoders
reaches; the conversion stays as it is.

    faultpath audit examples/lerobot_relative_actions.py:create --baseline encoders \
        --repair camera --fault joints:offset=0.1/0.1/0.1

Without LeRobot, `lerobot_steps.py` takes its place: a copy of the interface of these steps.
"""

from functools import cache

import numpy as np
import torch

from faultpath.system import ComposedSystem, FunctionPlant, Measure, Metric, Parts, writes

try:
    from lerobot.processor import AbsoluteActionsProcessorStep, RelativeActionsProcessorStep
except ImportError:
    from lerobot_steps import AbsoluteActionsProcessorStep, RelativeActionsProcessorStep

STATE, JOINTS, CHUNK, STEPS = "observation.state", 3, 4, 40  # a key of theirs; counts
REACH, NOISE, NEAR = 0.06, 0.005, 0.05  # rad: a step, of both sensors, a success


# --- policy ---
def steps():
    """Return their two steps, paired as their pipelines pair them."""
    relative = RelativeActionsProcessorStep(enabled=True)
    return relative, AbsoluteActionsProcessorStep(enabled=True, relative_step=relative)


def demonstrated(rng):
    """Return states, targets `[n, 3]` and absolute actions `[n, 4, 3]` of a demonstrator."""
    states, targets = rng.uniform(-1.5, 1.5, (2, 2000, 1, JOINTS))
    way = (targets - states) * np.linspace(0.25, 1, CHUNK)[:, None]
    actions = states + way + rng.normal(0, 0.02, way.shape)
    return (torch.tensor(x).float() for x in (states[:, 0], targets[:, 0], actions))


@cache
def fitted():
    """Return a policy `[n, 7] -> [n, 12]`, by least squares; rounded, since last bits vary."""
    states, targets, actions = demonstrated(np.random.default_rng(0))
    relative = steps()[0]({"observation": {STATE: states}, "action": actions})["action"]
    inputs = torch.cat([states, targets, torch.ones(len(states), 1)], dim=1).double()
    return torch.linalg.lstsq(inputs, relative.flatten(1).double()).solution.float()


# --- modules ---
def moves(weights, state, target):
    """Return how far the joints are to move, a chunk of actions `[4, 3]`."""
    return (torch.tensor(np.r_[state, target, 1.0]).float() @ weights).view(CHUNK, JOINTS).numpy()


def modules(sees):
    """Return the policy and the conversion; the policy takes its angles from what it `sees`."""

    @writes("relative_actions", of=fitted)
    def policy(weights, joints, target):
        return moves(weights, joints, target)

    @writes("relative_actions", of=fitted)
    def policy_of_camera(weights, camera, target):
        return moves(weights, camera, target)

    @writes("command", of=steps)
    def conversion(pair, joints, relative_actions):
        relative, absolute = pair
        relative({"observation": {STATE: torch.tensor(joints).float()[None]}})  # keeps it
        actions = torch.tensor(relative_actions)[None]
        return absolute({"action": actions})["action"][0, -1].numpy()  # the end of the chunk

    return [policy if sees == "joints" else policy_of_camera, conversion]


# --- scenes ---
def start(rng):
    return sensed(dict(zip(("place", "target"), rng.uniform(-1, 1, (2, JOINTS)), strict=True)), rng)


def sensed(state, rng):
    noise = rng.normal(0, NOISE, (2, JOINTS))
    return state | {"joints": state["place"] + noise[0], "camera": state["place"] + noise[1]}


def step(state, command, rng):
    place = state["place"] + np.clip(command - state["place"], -REACH, REACH)
    return sensed(state | {"place": place}, rng)


def missed_rad(episode):
    return np.abs(episode["place"][-1] - episode["target"][-1]).max()


# --- system ---
def create() -> ComposedSystem:
    sources = ("joints", "camera", "target", "place")
    plant = FunctionPlant(
        start,
        step,
        observes={name: name for name in sources},
        action="command",
        steps=STEPS,
        dt_s=0.1,
        succeeded=lambda episode: missed_rad(episode) <= NEAR,
        metrics={"missed_rad": Measure(Metric(unit="rad", better="less"), missed_rad)},
    )
    variants = {
        "encoders": Parts("Policy and conversion read the encoders.", modules("joints")),
        "camera": Parts("The policy's angles are a camera's.", modules("camera")),
    }
    units = dict.fromkeys((*sources, "command", "relative_actions"), "rad")
    return ComposedSystem("relative_actions", plant, variants, units)
