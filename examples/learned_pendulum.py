"""A learned world model in latent space that swings Gymnasium's pendulum up, and a repair of it.

Nobody measures how fast the pendulum turns, nor the torque that pushes at it. Two modules need the
gain of its motor, newton metres for a unit of command:

    encoder   makes a latent state of the last angles, the commands that were executed, and the gain
    planner   imagines where commands lead from that latent state, for which it needs the gain too,
              and takes the best (cross-entropy method)

One network holds both, fitted to predict the angles and rates to come. Baseline `exact` is fitted
with the true gain. Repair `uncertain` is fitted with a gain that errs by up to 40 %, once a window.

    faultpath audit examples/learned_pendulum.py:create --baseline exact --repair uncertain \
        --fault motor_gain:scale=0.6 --library selection --scenes 20

The weights lie beside this file. `python examples/learned_pendulum.py` fits others, into
`runs/learned-pendulum`; `--weights runs/learned-pendulum` audits those.
"""

# --- model ---
import argparse
from hashlib import sha256
from os.path import relpath
from pathlib import Path
from typing import Annotated, Any

import gymnasium
import numpy as np
import torch
from torch import nn

from faultpath import UserError, generator
from faultpath.learning import (
    Learned,
    Schedule,
    Windows,
    evaluate,
    fit,
    load,
    matched,
    uncertainty_training,
)
from faultpath.system import ComposedSystem, GymnasiumPlant, Measure, Metric, Module, Parts, Port

SHIPPED = Path(__file__).with_suffix("")
PAST, HORIZON, LATENT, DT_S = 6, 12, 16, 0.05  # steps, steps, numbers, s a control step
ANGLE, GAIN = Port("angle", "history"), Port("motor_gain", "history")
EXECUTED, IMAGINED = Port("command", "executed"), Port("motor_gain", "dynamics")


def layers(inputs, outputs):
    return nn.Sequential(nn.Linear(inputs, 64), nn.Tanh(), nn.Linear(64, outputs))


class Encoder(nn.Module):
    """The last angles, as cosine and sine, commands, and torques `[n, T, ...]` in."""

    def __init__(self):
        super().__init__()
        self.net = layers(4 * PAST, LATENT)

    def forward(self, inputs):
        torque = inputs[EXECUTED] * inputs[GAIN] / 8
        return self.net(torch.cat([inputs[ANGLE].flatten(1), torque, inputs[EXECUTED]], dim=1))


class WorldModel(nn.Module):
    def __init__(self):
        super().__init__()
        self.encoder, self.dynamics = Encoder(), layers(LATENT + 1, LATENT)
        self.decoder = layers(LATENT, 3)

    def imagine(self, latent, gain, commands):
        """Return cosine, sine and an eighth of the rate after each of `commands` `[n, H]`."""
        latents = []
        for command in commands.unbind(1):
            torque = (command * gain / 8)[:, None]
            latent = latent + self.dynamics(torch.cat([latent, torque], dim=1))
            latents.append(latent)
        return self.decoder(torch.stack(latents, dim=1))

    def forward(self, inputs):
        latent = self.encoder({port: value[:, :PAST] for port, value in inputs.items()})
        # What was executed after the present stands where the planner's commands will.
        return self.imagine(latent, inputs[IMAGINED][:, PAST - 1], inputs[EXECUTED][:, PAST:])


# --- planner ---
class Planner(Module):
    """Commands from -1 to 1 by the cross-entropy method, on imagined angles and rates."""

    name, writes = "planner", ("command",)
    reads = frozenset({Port("latent", "start"), IMAGINED})

    def __init__(self, model):
        self.model = model

    def begin(self, batch):
        return batch, torch.zeros(len(batch.scenes), HORIZON)

    def before(self, batch):
        return {"command": np.zeros(len(batch.scenes))}

    def noise_hashes(self, batch):
        return [sha256(f"{scene} {batch.seed}".encode()).hexdigest() for scene in batch.scenes]

    def step(self, inputs, memory):
        batch, plans = memory
        latents = torch.tensor(inputs["latent", "start"], dtype=torch.float32)
        gains = torch.tensor(inputs[IMAGINED], dtype=torch.float32)
        planned = []
        for i, scene in enumerate(batch.scenes):  # alone, so that its neighbours change no bit
            rng = generator("learned_pendulum/planner", scene, batch.seed, inputs.step)
            noise = torch.from_numpy(rng.normal(size=(3, 64, HORIZON)).astype(np.float32))
            planned.append(self.plan(latents[i], gains[i], plans[i], noise))
        plans = torch.stack(planned)
        command = plans[:, 0].numpy().astype(float)
        return {"command": command}, (batch, plans.roll(-1, dims=1))

    @torch.no_grad()
    def plan(self, latent, gain, plan, noise):
        for round_, spread in enumerate((0.6, 0.3, 0.15)):
            commands = (plan + spread * noise[round_]).clip(-1, 1)
            seen = self.model.imagine(latent.expand(64, -1), gain.expand(64), commands)
            angle, rate = torch.atan2(seen[..., 1], seen[..., 0]), 8 * seen[..., 2]
            cost = (angle**2 + 0.1 * rate**2 + 0.01 * commands**2).sum(dim=1)
            plan = commands[cost.argsort()[:8]].mean(dim=0)
        return plan


# --- scenes ---
SCENES = {  # seeds of resets that no window of the fit has
    "training": range(10_000, 10_100),
    "selection": range(10_500, 10_600),
    "held-out": range(11_000, 11_100),
}


class Pushed(gymnasium.ActionWrapper):
    """The pendulum with a motor of some gain, and a torque, N m, that nobody ordered."""

    gain, push = 8.0, 0.0

    def __init__(self):
        pendulum: Any = gymnasium.make("Pendulum-v1").unwrapped
        pendulum.max_torque = 100.0
        super().__init__(pendulum)

    def action(self, action):
        return self.gain * np.clip(action, -1, 1) + self.push


def setup(env, rng):
    env.gain, env.push = rng.uniform(6.0, 10.0), rng.uniform(-4.0, 4.0)
    return {"motor_gain": env.gain}


def offset_rad(flown):
    """Return how far from upright the pendulum was over the last second, on average."""
    cosine, sine = flown["angle"][-20:].T
    return float(np.abs(np.arctan2(sine, cosine)).mean())


# --- system ---
class LearnedPendulum(ComposedSystem):
    trained, folder = True, SHIPPED

    @property
    def data_files(self):
        return [relpath(file, SHIPPED.parent) for file in sorted(self.folder.glob("*"))]


def modules(name, folder):
    """Return the function that makes a variant's modules of a seed's weights."""

    def made(seed):
        model = WorldModel()
        if seed is not None:
            path = folder / f"{name}-{seed}.safetensors"
            if not path.is_file():
                raise UserError(f"no weights in {path}: python {__file__} --seed {seed} fits some.")
            load(model, path)
        encoder = Learned("encoder", model.encoder, "latent", [ANGLE, GAIN], [EXECUTED], PAST)
        return encoder, Planner(model)

    return made


def create(
    weights: Annotated[str, "Folder of fitted weights; default: those shipped."] = "",
) -> LearnedPendulum:
    plant = GymnasiumPlant(
        Pushed,
        observes={"angle": slice(0, 2)},
        action="command",
        steps=80,
        dt_s=DT_S,
        setup=setup,
        succeeded=lambda flown: offset_rad(flown) <= 0.15,
        metrics={"offset_rad": Measure(Metric(unit="rad", better="less"), offset_rad)},
    )
    folder = Path(weights).absolute() if weights else SHIPPED
    system = LearnedPendulum(
        "learned_pendulum",
        plant,
        variants={
            "exact": Parts("Fitted with the true gain.", modules("exact", folder)),
            "uncertain": Parts("Fitted with a gain that errs.", modules("uncertain", folder)),
        },
        units={"angle": "1", "motor_gain": "N m", "latent": "1", "command": "1"},
        scenes=SCENES,
    )
    system.folder = folder
    return system


# --- fit ---
def windows(count):
    """Return windows of random commands, each from a reset of its own."""
    env, steps = Pushed(), PAST + HORIZON
    seen, executed = np.zeros((count, steps, 3)), np.zeros((count, steps))
    gain, ids = np.zeros(count), [f"window/{i}" for i in range(count)]
    for i, name in enumerate(ids):
        rng = generator("learned_pendulum/window", name, 0)
        gain[i] = setup(env, rng)["motor_gain"]
        near = {"x_init": 0.6, "y_init": 2.0} if i % 2 else None  # every other one near upright
        seen[i, 0], _ = env.reset(seed=i, options=near)
        executed[i, 1:] = np.clip(rng.normal(rng.uniform(-1, 1), 0.6, steps - 1), -1, 1)
        for k in range(1, steps):
            seen[i, k] = env.step(executed[i, k : k + 1])[0]
    readings = {"angle": seen[..., :2], "command": executed, "motor_gain": gain}
    return Windows(
        create().interface,
        reader=("encoder", "planner.dynamics"),
        readings={channel: values.astype(np.float32) for channel, values in readings.items()},
        targets=(seen[:, PAST:] / [1, 1, 8]).astype(np.float32),
        dt_s=DT_S,
        ids=ids,
    )


def fit_both(folder, seed, count, epochs):
    data = windows(count)
    schedule = Schedule(epochs=epochs, batch_size=128, learning_rate=1.5e-3, clip_norm=1.0)
    told = {"schedule": schedule, "seed": seed, "folder": folder}
    error = uncertainty_training("motor_gain:uniform_scale=0.4")
    exact = fit(WorldModel, data, name="exact", **told)
    uncertain = fit(WorldModel, data, name="uncertain", repair=error, **told)
    print(matched(exact, uncertain))
    for name, each in (("exact", exact), ("uncertain", uncertain)):
        wrong = evaluate(each, data, faults=["motor_gain:scale=0.6"])
        print(f"{name}: {evaluate(each, data):.4f} with the true gain, {wrong:.4f} with 0.6 of it")


def main():
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--folder", type=Path, default=Path("runs/learned-pendulum"))
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--windows", type=int, default=3000)
    parser.add_argument("--epochs", type=int, default=120)
    given = parser.parse_args()
    fit_both(given.folder, given.seed, given.windows, given.epochs)


if __name__ == "__main__":
    main()
