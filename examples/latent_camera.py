"""One camera for where you are and where you want to be: a latent world model and its repairs.

A dot in two rooms with a door between them is to end at a goal. As with DINO-WM, LeWM, PLDM or
V-JEPA 2-AC, the controller gets both as pictures, one encoder makes latent states of them, and the
planner looks for actions that bring the one closest to the other (cross-entropy method). Four
numbers say what the camera does to a picture, and two modules take pictures with it:

    observation   the live picture, at every step
    goal          the picture of the goal, once, beforehand

    faultpath audit examples/latent_camera.py:create --baseline plain --repair augmented \
        --fault exposure:scale=0.85 --library selection --scenes 20

The weights lie beside this file. `python examples/latent_camera.py` fits others, into
`runs/latent-camera`; `--weights runs/latent-camera` audits those.
"""

import argparse
from functools import cached_property
from hashlib import sha256
from os.path import relpath
from pathlib import Path
from typing import Annotated

import numpy as np
import torch
from latent_camera_pictures import DOOR, SIDE, WALL, Rectified, Rooms, picture
from torch import nn

from faultpath import UserError, generator
from faultpath.learning import Schedule, Windows, fit, load, matched, uncertainty_training
from faultpath.system import (
    Library,
    LoopSystem,
    Metric,
    Module,
    Plant,
    Port,
    Progress,
    SceneRef,
    Status,
    interface_of,
)

SHIPPED = Path(__file__).with_suffix("")
REACH, STEPS, HORIZON, LATENT = 4.0, 12, 6, 32  # px a step; steps
WINDOW, ROUNDS, SAMPLES, ELITES = 4, 8, 64, 6  # frames of a window; of the planner
LEAST, MOST = 3.0, 29.0  # the ends of the rooms, px
NEAR = 2.5  # px from the goal at the end that count as success
CAMERA = ("exposure", "gamma", "shift", "smear")


# --- model ---
def edges_of(pictures):
    """Return how steep the pictures are, relative to their mean steepness: no exposure is left."""
    across = nn.functional.pad(pictures, (1, 1, 0, 0), mode="replicate").diff(n=1, dim=3)
    down = nn.functional.pad(pictures, (0, 0, 1, 1), mode="replicate").diff(n=1, dim=2)
    steep = (across[..., 1:] ** 2 + down[..., 1:, :] ** 2 + 1e-8).sqrt()
    return 0.2 * steep / steep.mean(dim=(1, 2, 3), keepdim=True)


class WorldModel(nn.Module):
    """A joint-embedding world model, with the regulariser of VICReg as PLDM has it."""

    def __init__(self, rooms: Rooms = "marked", edges: bool = False):
        super().__init__()
        self.rooms, self.edges = rooms, edges
        parts = []
        for inputs, outputs in ((1, 16), (16, 32), (32, 64)):
            conv = nn.Conv2d(inputs, outputs, 3, stride=2, padding=1, bias=False)
            parts += [conv, nn.BatchNorm2d(outputs), nn.ReLU()]
        encoder = nn.Sequential(*parts, nn.Flatten(), nn.Linear(1024, LATENT))
        self.encoder = encoder.to(memory_format=torch.channels_last)  # faster to fit
        self.dynamics = nn.Sequential(nn.Linear(LATENT + 2, 128), nn.ReLU(), nn.Linear(128, LATENT))
        self.inverse = nn.Sequential(nn.Linear(2 * LATENT, 32), nn.ReLU(), nn.Linear(32, 2))

    def encode(self, pictures):
        return self.encoder(4 * ((edges_of(pictures) if self.edges else pictures) - 0.4))

    def imagine(self, latent, actions):
        """Return the latent states `[n, H, LATENT]` after each of `actions` `[n, H, 2]`."""
        latents = []
        for action in actions.unbind(1):
            latent = latent + self.dynamics(torch.cat([latent, action], dim=1))
            latents.append(latent)
        return torch.stack(latents, dim=1)

    def forward(self, inputs):
        """Return the latent states `[n, T, LATENT]` of windows, and the model that imagines."""
        seen = [inputs[channel, "picture"].flatten(0, 1) for channel in ("live_view", *CAMERA)]
        latents = self.encode(picture(*seen, self.rooms))
        return latents.view(-1, WINDOW, LATENT), self


def latent_loss(output, actions):
    """25 prediction + 25 variance + 1 covariance + 1 inverse dynamics (VICReg, PLDM)."""
    latents, model = output
    flat = latents.flatten(0, 1)
    centred = flat - flat.mean(dim=0)
    covariance = centred.T @ centred / (len(flat) - 1)
    spread = (covariance.diagonal() + 1e-4).sqrt()
    apart = (covariance - covariance.diagonal().diag()).square().sum() / LATENT
    ahead = nn.functional.mse_loss(model.imagine(latents[:, 0], actions), latents[:, 1:])
    recognised = model.inverse(torch.cat([latents[:, :-1], latents[:, 1:]], dim=2))
    narrow = (1 - spread).clamp(min=0).mean()
    return 25 * ahead + 25 * narrow + apart + nn.functional.mse_loss(recognised, actions)


# --- modules ---
class Eye(Module):
    """Takes a picture through the camera and encodes it; `once` where it was taken beforehand."""

    def __init__(self, name, view, latent, model, prepared, once=False):
        self.name, self.writes = name, (latent,)
        self.reads = frozenset(Port(channel, "picture") for channel in (view, *CAMERA))
        self.at_read = self.reads if once else frozenset()
        self.view, self.model, self.prepared, self.once = view, model, prepared, once

    @torch.no_grad()
    def step(self, inputs, memory):
        if memory is not None and self.once:
            return {self.writes[0]: memory}, memory
        read = [inputs[channel, "picture"] for channel in (self.view, *CAMERA)]
        pictures = picture(*(torch.tensor(x, dtype=torch.float32) for x in read), self.model.rooms)
        # One by one: a convolution may round a picture by those beside it.
        encoded = [self.model.encode(self.prepared(seen)) for seen in pictures.split(1)]
        latent = torch.cat(encoded).numpy().astype(float)
        return {self.writes[0]: latent}, latent


class Planner(Module):
    """Actions from -1 to 1 by the cross-entropy method, on distances of latent states."""

    name, writes = "planner", ("action",)
    start, target = Port("latent", "start"), Port("goal_latent", "target")
    reads = frozenset({start, target})

    def __init__(self, model):
        self.model = model

    def begin(self, batch):
        return batch, torch.zeros(len(batch.scenes), HORIZON, 2)

    def noise_hashes(self, batch):
        return [sha256(f"{scene} {batch.seed}".encode()).hexdigest() for scene in batch.scenes]

    def step(self, inputs, memory):
        batch, plans = memory
        start, target = (torch.tensor(inputs[end]).float() for end in (self.start, self.target))
        noise = np.empty((len(batch.scenes), ROUNDS, SAMPLES, HORIZON, 2), np.float32)
        for i, scene in enumerate(batch.scenes):
            rng = generator("latent_camera/planner", scene, batch.seed, inputs.step)
            rng.standard_normal(dtype=np.float32, out=noise[i])
        plans = self.plan(start, target, plans, torch.from_numpy(noise))
        following = torch.cat([plans[:, 1:], torch.zeros_like(plans[:, :1])], dim=1)
        return {"action": plans[:, 0].numpy().astype(float)}, (batch, following)

    @torch.no_grad()
    def plan(self, start, target, mean, noise):
        """Return the best plan that was met, `[B, H, 2]`: a mean of good plans is often bad."""
        spread, least = torch.ones_like(mean), torch.full((len(mean),), torch.inf)
        best, rows = mean, torch.arange(len(mean))
        for draw in noise.unbind(1):
            plans = (mean[:, None] + spread[:, None] * draw).clamp(-1, 1)
            cost = self.cost(start, target, plans)
            order = cost.argsort(dim=1, stable=True)[:, :ELITES]
            elites = plans[rows[:, None], order]
            better = cost[rows, order[:, 0]] < least
            least = torch.where(better, cost[rows, order[:, 0]], least)
            best = torch.where(better[:, None, None], elites[:, 0], best)
            mean, spread = elites.mean(dim=1), elites.std(dim=1) + 0.05
        return best

    def cost(self, start, target, plans):
        """Return the squared distances to the target, summed over the horizon, `[B, N]`."""
        first, _, last = self.model.dynamics

        def layer(values, part):  # scene by scene, each with a product of its own
            return torch.baddbmm(part.bias, values, part.weight.T.expand(len(start), -1, -1))

        latent = start[:, None].expand(-1, plans.shape[1], -1)
        cost = torch.zeros(plans.shape[:2])
        for action in plans.unbind(2):
            pushed = layer(torch.cat([latent, action], dim=2), first)
            latent = latent + layer(pushed.relu_(), last)
            cost += (latent - target[:, None]).square().sum(dim=2)
        return cost


# --- rooms ---
FACTS = """
name: latent_camera
sources:
- {name: here, unit: px, shape: [2], provenance: measured}
- {name: there, unit: px, shape: [2], provenance: measured}
- {name: exposure, unit: '1', provenance: measured, correlation_group: camera, scale: 1.0,
   uncertainty: {std: 0.15, relative: true}}
- {name: gamma, unit: '1', provenance: measured, correlation_group: camera, scale: 1.0,
   uncertainty: {std: 0.15, relative: true}}
- {name: shift, unit: px, shape: [2], provenance: measured, correlation_group: camera, scale: 1.0,
   uncertainty: {std: 1.0}}
- {name: smear, unit: px, provenance: measured, correlation_group: camera, scale: 1.0,
   uncertainty: {std: 3.0}}
- {name: latent, unit: '1', shape: [32], provenance: reconstructed}
- {name: goal_latent, unit: '1', shape: [32], provenance: reconstructed}
- {name: action, unit: '1', shape: [2], provenance: commanded}
channels:
- {name: live_view, sources: [here]}
- {name: goal_view, sources: [there]}
- {name: exposure, sources: [exposure], gap: fidelity, erasure_default: 1.0}
- {name: gamma, sources: [gamma], gap: fidelity, erasure_default: 1.0}
- {name: shift, sources: [shift], gap: fidelity}
- {name: smear, sources: [smear], gap: fidelity}
- {name: latent, sources: [latent]}
- {name: goal_latent, sources: [goal_latent]}
- {name: action, sources: [action]}
"""


def moved(place, action):
    """Return places `[B, 2]` after an action: the wall stops what runs into it."""
    way = np.clip(action, -1, 1)
    way = REACH * way / np.maximum(np.linalg.norm(way, axis=1, keepdims=True), 1) / 5
    for _ in range(5):
        for axis in np.eye(2):
            ahead = np.clip(place + axis * way, LEAST, MOST)
            inside = (ahead[:, 0] > WALL[0] - 1) & (ahead[:, 0] < WALL[1] + 1)
            inside &= (ahead[:, 1] < DOOR[0] + 1) | (ahead[:, 1] > DOOR[1] - 1)
            place = np.where(inside[:, None], place, ahead)
    return place


def drawn(rng, count, side=None):
    """Return places `[count, 2]` in the left room, 0, or the right one, 1; by default in both."""
    place = rng.uniform([LEAST, LEAST], [WALL[0] - 1, MOST], (count, 2))
    right = rng.random(count) < 0.5 if side is None else np.full(count, bool(side))
    place[right, 0] = SIDE - place[right, 0]
    return place


class TwoRooms(Plant):
    name, steps = "rooms", STEPS
    senses = ("here", "there", *CAMERA)
    reads = frozenset({Port("action", "motor")})

    def start(self, batch):
        ends = []
        for scene in batch.scenes:
            rng = generator("latent_camera/scene", scene, 0)
            side = rng.integers(2)
            ends.append([drawn(rng, 1, side)[0], drawn(rng, 1, 1 - side)[0]])
        start, goal = np.array(ends).swapaxes(0, 1)
        return start, goal, start, 0

    def sense(self, state):
        _, goal, place, _ = state
        one, shift = np.ones(len(goal)), np.zeros((len(goal), 2))
        return dict(zip(self.senses, (place, goal, one, one, shift, 0 * one), strict=True))

    def advance(self, state, inputs):
        start, goal, place, step = state
        return start, goal, moved(place, inputs["action", "motor"]), step + 1

    def progress(self, state):
        _, goal, place, step = state
        missed = np.linalg.norm(place - goal, axis=1)
        over, none = np.full(len(missed), step >= STEPS), np.zeros(len(missed), bool)
        times, metrics = np.full(len(missed), float(step)), {"missed_px": missed}
        return Progress(~over, over & (missed <= NEAR), none, times, metrics)

    def conditions(self, state):
        ends = np.concatenate(state[:2], axis=1)
        return [sha256(row.tobytes()).hexdigest()[:16] for row in ends], ["none"] * len(ends)


# --- system ---
LIBRARIES = {"training": 100, "selection": 100, "held-out": 300}
VARIANTS = {
    "plain": "Fitted to what a calibrated camera sees.",
    "augmented": "Fitted with errors of the camera, drawn anew for every frame.",
    "clip": "Fitted with errors of the camera, drawn once a clip.",
    "edges": "Fitted to how steep the picture is instead of the picture.",
    "rectified": "As plain; the live picture is rectified, goal pictures stay as they were taken.",
    "rectified-both": "As plain; the live picture and the goal picture are rectified.",
}
BLANK = ("plain", "augmented")  # variants where nothing is seen but the dot


class LatentCamera(LoopSystem):
    name, control_dt_s, block_size, trained = "latent_camera", 1.0, 25, True
    metrics = {  # noqa: RUF012 - never changed
        "missed_px": Metric(unit="px", better="less", words="distance from the goal")
    }
    ends = {Status.TIMEOUT: "missed"}  # noqa: RUF012 - never changed

    def __init__(self, rooms: Rooms, folder: Path):
        self.rooms, self.folder = rooms, folder

    @property
    def descriptions(self):
        names = VARIANTS if self.rooms == "marked" else BLANK
        return {name: VARIANTS[name] for name in names}

    @cached_property
    def interface(self):
        return interface_of(FACTS, (*self.modules("plain", None), TwoRooms()))

    def plant(self):
        return TwoRooms()

    def modules(self, variant, seed):
        fitted = "plain" if variant.startswith("rectified") else variant
        model = WorldModel(self.rooms, edges=fitted == "edges").eval()
        if seed is not None:
            path = self.folder / f"{self.rooms}-{fitted}-{seed}.safetensors"
            if not path.is_file():
                raise UserError(f"no weights in {path}: python {__file__} --seed {seed} fits some.")
            load(model, path)
        live = Rectified() if variant.startswith("rectified") else nn.Identity()
        there = live if variant == "rectified-both" else nn.Identity()
        observation = Eye("observation", "live_view", "latent", model, live)
        goal = Eye("goal", "goal_view", "goal_latent", model, there, once=True)
        return observation, goal, Planner(model)

    @property
    def data_files(self):
        files = sorted(self.folder.glob(f"{self.rooms}-*"))
        return [relpath(file, SHIPPED.parent) for file in files]

    def library(self, name: str) -> Library:
        if name not in LIBRARIES:
            raise UserError(f"the rooms have no library '{name}': choose {', '.join(LIBRARIES)}.")
        scenes = tuple(SceneRef(f"{name}/{i:03d}", i) for i in range(LIBRARIES[name]))
        return Library(name, scenes, "rooms-1")


def create(
    rooms: Annotated[Rooms, "Rooms whose floor and walls are seen, or blank ones."] = "marked",
    weights: Annotated[str, "Folder of fitted weights; default: those shipped."] = "",
) -> LatentCamera:
    return LatentCamera(rooms, Path(weights).absolute() if weights else SHIPPED)


# --- fit ---
LASTING = {"augmented": "noise", "clip": "bias"}  # errors of one frame, and of a window


def windows(interface, count):
    """Return windows of random walks, three actions each."""
    rng = generator("latent_camera/windows", "all", 0)
    places = [drawn(rng, count)]
    kept, actions = rng.normal(0, 0.8, (count, 2)), []
    for _ in range(WINDOW - 1):
        actions.append(np.clip(kept + rng.normal(0, 0.5, (count, 2)), -1, 1))
        places.append(moved(places[-1], actions[-1]))
    readings = {"live_view": np.stack(places, axis=1), "shift": np.zeros((count, 2))}
    readings |= {"exposure": np.ones(count), "gamma": np.ones(count), "smear": np.zeros(count)}
    return Windows(
        interface,
        reader="observation",
        readings={channel: values.astype(np.float32) for channel, values in readings.items()},
        targets=np.stack(actions, axis=1).astype(np.float32),
        dt_s=1.0,
    )


def fitted(name, rooms, seed, data, folder, epochs):
    """Return a fitted model; one that the folder has is not fitted again."""
    path = folder / f"{rooms}-{name}-{seed}.safetensors"
    if path.with_suffix(".json").is_file():
        return load(WorldModel(rooms, name == "edges"), path)
    schedule = Schedule(epochs=epochs, batch_size=64, learning_rate=1e-3)
    told = {"seed": seed, "schedule": schedule, "name": f"{rooms}-{name}", "folder": folder}
    if name in LASTING:  # of the sizes that the interface declares
        lights = [f"{channel}:{LASTING[name]}=0.15,relative" for channel in ("exposure", "gamma")]
        told["repair"] = uncertainty_training(*lights, f"shift:{LASTING[name]}=1")
    return fit(lambda: WorldModel(rooms, name == "edges"), data, latent_loss, **told)


def main():
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--folder", type=Path, default=Path("runs/latent-camera"))
    parser.add_argument("--rooms", choices=("marked", "blank"), default="marked")
    parser.add_argument("--names", default="plain,augmented,clip,edges")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--windows", type=int, default=35_600)
    parser.add_argument("--epochs", type=int, default=5)
    given = parser.parse_args()
    torch.set_num_threads(1)
    data = windows(create(given.rooms).interface, given.windows)
    told = given.rooms, given.seed, data, given.folder, given.epochs
    fits = {name: fitted(name, *told) for name in given.names.split(",")}
    for name in LASTING.keys() & fits.keys():
        print(f"{name}: {matched(fits['plain'], fits[name])}")


if __name__ == "__main__":
    main()
