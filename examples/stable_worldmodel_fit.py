"""Fit the two latent models that `stable_worldmodel_camera.py` flies: `plain` and `augmented`.

Windows of five frames, five actions apart, of their expert with the noise that they collect with;
their `PLDMLoss` with the weights that they train with, and an inverse-dynamics term.

    python examples/stable_worldmodel_fit.py --seed 0
"""

import argparse
from pathlib import Path

import numpy as np
import torch
from PIL import Image
from safetensors.torch import save_file
from stable_worldmodel_model import (
    LATENT,
    SCALER,
    SIDE,
    WEIGHTS,
    photographed,
    two_room,
    world_model,
)
from torch import nn
from torch.nn import functional

from stable_worldmodel.wm.loss import PLDMLoss  # isort: skip - after what the example prepares

FRAMES, BLOCK, EXPOSURE, SHIFT = 5, 5, 0.15, 1.0  # the last two: deviations of errors, 1 and px


def windows(count):
    """Return pictures `[n, 5, 64, 64, 3]` and scaled actions `[n, 4, 10]`."""
    rooms = two_room.TwoRoomEnv()
    pictures = np.empty((count, FRAMES, SIDE, SIDE, 3), np.uint8)
    actions = np.empty((count, FRAMES - 1, BLOCK, 2), np.float32)
    for i in range(count):
        expert = two_room.ExpertPolicy(2.0, 0.05, seed=20_000 + i)
        _, info = rooms.reset(seed=20_000 + i)
        expert.set_env(rooms)
        for frame in range(FRAMES):
            seen = Image.fromarray(rooms.render()).resize((SIDE, SIDE), Image.Resampling.BILINEAR)
            pictures[i, frame] = np.asarray(seen)
            for k in range(BLOCK if frame < FRAMES - 1 else 0):
                actions[i, frame, k] = expert.get_action(info)
                info = rooms.step(actions[i, frame, k])[4]
    return pictures, SCALER.transform(actions).reshape(count, FRAMES - 1, -1).astype(np.float32)


def loss_of(model, inverse, pictures, actions):
    """Return the loss of windows of pictures `[n, 5, 3, 64, 64]`."""
    latents = model.encode({"pixels": pictures})["emb"]
    predicted, ahead = latents[:, 0], []
    for action in actions.unbind(1):
        predicted = model.predict(predicted[:, None], action[:, None])[:, 0]
        ahead.append(functional.mse_loss(predicted, latents[:, len(ahead) + 1]))
    guess = inverse(torch.cat([latents[:, 1:], latents[:, :-1]], dim=-1))
    parts = PLDMLoss()(latents, guess, actions)
    weights = {"std": 18, "std_t": 0.7, "cov": 12, "temp_align": 0.2, "idm": 1}
    rest = [weight * parts[f"{name}_loss"] for name, weight in weights.items()]
    return torch.stack(ahead).sum(), torch.stack(rest).sum()


def fitted(pictures, actions, seed, augmented, epochs):
    torch.manual_seed(seed)
    model = world_model()
    inverse = nn.Sequential(nn.Linear(2 * LATENT, 64), nn.ReLU(), nn.Linear(64, 10))
    parameters = [*model.parameters(), *inverse.parameters()]
    optimiser = torch.optim.AdamW(parameters, lr=1e-3, weight_decay=1e-3)
    steps = epochs * (len(pictures) // 64)
    schedule = torch.optim.lr_scheduler.OneCycleLR(optimiser, 1e-3, total_steps=steps)
    order, errors = torch.Generator().manual_seed(seed), torch.Generator().manual_seed(seed + 100)
    for epoch in range(epochs):
        losses = []
        for rows in torch.randperm(len(pictures), generator=order).split(64)[: steps // epochs]:
            seen = torch.from_numpy(pictures[rows]).flatten(0, 1).movedim(3, 1) / 255
            if augmented:
                exposure = 1 + EXPOSURE * torch.randn(len(seen), generator=errors)
                shift = SHIFT * torch.randn(len(seen), 2, generator=errors)
                seen = photographed(seen, exposure.clamp(min=0.1), shift)
            ahead, rest = loss_of(
                model, inverse, seen.unflatten(0, (-1, FRAMES)), torch.from_numpy(actions[rows])
            )
            optimiser.zero_grad()
            (ahead + rest).backward()
            optimiser.step()
            schedule.step()
            losses.append([float(ahead.detach()), float(rest.detach())])
        print(epoch, *np.mean(losses, axis=0).round(4), flush=True)
    return model


def main():
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--folder", type=Path, default=WEIGHTS)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--windows", type=int, default=6000)
    parser.add_argument("--epochs", type=int, default=10)
    parser.add_argument("--names", default="plain,augmented")
    options = parser.parse_args()
    torch.set_num_threads(1)
    data = windows(options.windows)
    for name in options.names.split(","):
        with torch.random.fork_rng():  # the caller's random numbers stay as they were
            model = fitted(*data, options.seed, name == "augmented", options.epochs)
        save_file(model.state_dict(), options.folder / f"{name}-{options.seed}.safetensors")


if __name__ == "__main__":
    main()
