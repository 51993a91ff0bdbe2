"""stable-worldmodel's rooms, planner and policy, untouched: one camera, read twice.

Their `WorldModelPolicy` prepares the live picture and the picture of the goal, each in a `process`
of its own, and their `PLDM` encodes both; `CEMSolver` looks for actions that bring the one latent
state to the other. An error of the camera may strike the observation, the goal, or both.

    faultpath audit examples/stable_worldmodel_camera.py:create --baseline plain \
        --repair augmented --fault exposure:scale=0.7 --library selection --scenes 20
"""

from contextlib import redirect_stdout
from functools import partial
from io import StringIO
from types import SimpleNamespace

import gymnasium
import numpy as np
from stable_worldmodel_model import SCALER, SIDE, WEIGHTS, camera, fitted, scaled, swm, two_room

from faultpath.system import ComposedSystem, GymnasiumPlant, Measure, Metric, Parts, tapped, writes

STEPS, AHEAD = 50, 25  # of a trial, and to the goal; all of these as they evaluate
CEM = {"num_samples": 300, "n_steps": 30, "topk": 30}
PLAN = swm.PlanConfig(horizon=5, receding_horizon=5, action_block=5)


# --- modules ---
ONE, MANY = (gymnasium.spaces.Box(-1, 1, shape) for shape in ((2,), (1, 2)))
SPACES = SimpleNamespace(num_envs=1, action_space=MANY, single_action_space=ONE)


def policy_of(model, seed, rectifies):
    """Return their policy; an audit delivers exposure and shift where it takes its two pictures."""
    live = partial(camera, rectifies=rectifies)
    process = {
        "pixels": SimpleNamespace(transform=tapped(live, "exposure", "shift", at="observation")),
        "goal": SimpleNamespace(transform=tapped(camera, "exposure", "shift", at="goal")),
        "action": SCALER,
    }
    transform = dict.fromkeys(("pixels", "goal"), scaled)
    solver = swm.solver.CEMSolver(model, seed=seed, **CEM)
    policy = swm.policy.WorldModelPolicy(solver, PLAN, process, transform)
    policy.set_env(SPACES)
    return policy


@writes("command", of=policy_of)
def planner(policy, picture, goal_picture):
    seen = {"pixels": picture[None, None], "goal": goal_picture[None, None]}
    with redirect_stdout(StringIO()):  # their solver prints how long it took
        return policy.get_action(seen | {"action": np.zeros((1, 1, 2))})[0]


def modules(name, rectifies=False):
    return lambda seed: [
        planner.given(model=fitted(name, seed), seed=seed or 0, rectifies=rectifies)
    ]


# --- scenes ---
class Rooms(gymnasium.Wrapper):
    """Their rooms; as in their evaluation, the goal is where their expert is 25 steps later."""

    def __init__(self):
        rooms = gymnasium.make("swm/TwoRoom-v1", disable_env_checker=True).unwrapped
        super().__init__(swm.wrapper.MegaWrapper(rooms, image_shape=(SIDE, SIDE)))

    def reset(self, *, seed=None, options=None):
        rooms, expert = self.unwrapped, two_room.ExpertPolicy(2.0, 0.05, seed=seed)
        expert.set_env(rooms)
        _, first = self.env.reset(seed=seed, options=options)
        last = first
        for k in range(AHEAD):
            moved = self.env if k == AHEAD - 1 else rooms  # only the last is to be seen
            last = moved.step(expert.get_action(last))[4]
        self.goal = last["pixels"]
        rooms._set_goal_state(last["state"])
        rooms._set_state(first["state"])
        return self.seen(first["pixels"], np.hypot(*(first["state"] - last["state"]))), {}

    def step(self, action):
        _, reward, terminated, truncated, info = self.env.step(action)
        seen = self.seen(info["pixels"], info["distance_to_target"])
        return seen, reward, terminated, truncated, {}

    def seen(self, picture, distance):
        return {"picture": picture, "goal_picture": self.goal, "distance": distance}


# --- system ---
VARIANTS = {
    "plain": Parts("Fitted to what a calibrated camera sees.", modules("plain")),
    "augmented": Parts("Fitted with errors of the camera, frame by frame.", modules("augmented")),
    "rectified": Parts("As plain; errors are undone in the live picture.", modules("plain", True)),
}


class TwoRooms(ComposedSystem):
    trained = True


def create() -> TwoRooms:
    closest = Measure(Metric(unit="px", better="less"), lambda seen: seen["distance"].min())
    plant = GymnasiumPlant(
        Rooms,
        observes={name: name for name in ("picture", "goal_picture", "distance")},
        action="command",
        steps=STEPS,
        dt_s=1.0,
        setup=lambda rooms, rng: {"exposure": 1.0, "shift": np.zeros(2)},
        succeeded=lambda episode: episode.terminated,  # as theirs: within 16 of 224 px
        metrics={"closest_px": closest},
    )
    units = dict.fromkeys(("picture", "goal_picture", "exposure", "command"), "1")
    units |= dict.fromkeys(("shift", "distance"), "px")
    return TwoRooms("two_rooms", plant, VARIANTS, units, data_files=[WEIGHTS.name])
