"""The small latent model and the camera of `stable_worldmodel_camera.py`.

Their `PLDM` plans with them: it encodes, imagines and compares, and neither part is theirs.
"""

from functools import cache
from importlib.metadata import version
from pathlib import Path
from types import SimpleNamespace
from warnings import catch_warnings

import numpy as np
import torch
from PIL import Image
from safetensors.torch import load_file
from torch import nn
from torch.nn import functional

if "+cpu" in torch.__version__ and "+cpu" not in version("torchvision"):
    for name in ("nms", "qnms"):  # a torchvision for GPUs misses these; nothing here calls them
        torch.library.define(f"torchvision::{name}", "(Tensor a, Tensor b, float c) -> Tensor")
with catch_warnings(action="ignore"):  # about optional parts of stable-worldmodel
    import stable_worldmodel as swm
    from stable_worldmodel.envs import two_room
    from stable_worldmodel.wm.pldm import PLDM

SCALER = swm.data.ZScoreScaler(mean=np.zeros((1, 2)), std=np.full((1, 2), 0.8))  # of actions
WEIGHTS = Path(__file__).with_name("stable_worldmodel_camera")
SIDE, LATENT = 64, 32  # px, numbers


# --- model ---
class Encoder(nn.Module):
    """Pictures `[n, 3, 64, 64]` from 0 to 1; returns what their models expect of a transformer."""

    def __init__(self):
        super().__init__()
        parts = []
        for inputs, outputs in ((3, 16), (16, 32), (32, 64), (64, 64)):
            parts += [nn.Conv2d(inputs, outputs, 3, stride=2, padding=1), nn.ReLU()]
        self.net = nn.Sequential(*parts, nn.Flatten(), nn.Linear(1024, LATENT))

    def forward(self, pictures, interpolate_pos_encoding=False):
        return SimpleNamespace(last_hidden_state=self.net(2 * pictures - 1)[:, None])


class Predictor(nn.Module):
    num_frames = 1  # of the past, as their rollout asks

    def __init__(self):
        super().__init__()
        self.net = nn.Sequential(nn.Linear(LATENT + 10, 128), nn.ReLU(), nn.Linear(128, LATENT))

    def forward(self, latents, actions):
        return latents + self.net(torch.cat([latents, actions], dim=-1))


def world_model():
    return PLDM(Encoder(), Predictor(), nn.Identity())


def fitted(name, seed):
    model = world_model().eval().requires_grad_(False)
    if seed is not None:
        model.load_state_dict(load_file(WEIGHTS / f"{name}-{seed}.safetensors"))
    return model


# --- camera ---
def photographed(pictures, exposure, shift):
    """Return `[n, 3, 64, 64]` from 0 to 1 with exposures `[n]` and shifts `[n, 2]`, px."""
    turn = torch.eye(2).expand(len(pictures), 2, 2)
    where = torch.cat([turn, -2 * shift[:, :, None] / SIDE], dim=2)
    grid = functional.affine_grid(where, list(pictures.shape), align_corners=False)
    moved = functional.grid_sample(pictures, grid, padding_mode="border", align_corners=False)
    return (exposure[:, None, None, None] * moved).clamp(0, 1)


@cache
def empty_rooms():
    """Return shifts `[n, 2]` and the red channel so shifted, which no dot is seen in."""
    rooms = two_room.TwoRoomEnv()
    rooms.reset(seed=0)
    seen = Image.fromarray(rooms.render()).resize((SIDE, SIDE), Image.Resampling.BILINEAR)
    red = torch.tensor(np.array(seen)).movedim(2, 0)[None, :1] / 255
    steps = torch.arange(-3, 3.01, 0.5)
    shifts = torch.cartesian_prod(steps, steps)
    return shifts, photographed(red.expand(len(shifts), -1, -1, -1), torch.ones(1), shifts)


def camera(pictures, exposure, shift, rectifies=False):
    """Return pictures `[n, 64, 64, 3]` as a camera takes them."""
    seen = torch.tensor(pictures).movedim(3, 1) / 255
    exposure, shift = np.array(exposure, ndmin=1), np.array(shift, ndmin=2)
    seen = photographed(seen, torch.tensor(exposure).float(), torch.tensor(shift).float())
    seen = (255 * seen).round() / 255
    if rectifies:
        seen = rectified(seen)
    return (255 * seen).round().byte().movedim(1, 3).numpy()


def rectified(picture):
    """Return one picture with the exposure and the shift undone that its red channel shows."""
    level, (shifts, rooms) = picture.median(), empty_rooms()  # most of a picture is white floor
    apart = (rooms - picture[:, :1] / level).square().mean(dim=(1, 2, 3))
    return photographed(picture, 1 / level[None], -shifts[apart.argmin()][None])


def scaled(picture):
    return picture.float() / 255
