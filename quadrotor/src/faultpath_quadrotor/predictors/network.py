"""The recurrent network of the learned predictors: history encoder, latent update, head.

Components first: features are `[F, *batch]` and a linear map is `weight @ features`, which leaves
the batch contiguous for the kinematics. A column of such a product has the same bits whatever the
other columns are, as long as their number is a multiple of 32.
"""

import math
from dataclasses import dataclass

import torch
from torch import Tensor, nn
from torch.nn import functional

from faultpath_quadrotor.batching import Delivered
from faultpath_quadrotor.native.kernel_args import covered, lend, output, tell_portable
from faultpath_quadrotor.native.library import kernels_for, kernels_on
from faultpath_quadrotor.state import State
from faultpath_quadrotor.vehicle import GRAVITY_MPS2

LATENT = 32  # paper, Section IV-A
MOST_INPUTS = 32
"""Inputs for which `recurrent.cpp` has room; its latent is `LATENT`."""
ACTION_EMBEDDING = 16  # derived: with it the parameter counts are the paper's
STATE_FEATURES = 15
ACTION_FEATURES = 4
BASE_FEATURES = STATE_FEATURES + ACTION_FEATURES  # 19 (paper, Section IV-A)


def affine(weight: Tensor, bias: Tensor, x: Tensor, gelu: bool = False) -> Tensor:
    """Return `weight @ x + bias` `[outputs, N]`, through a Gaussian error linear unit if asked.

    `weight` is `[outputs, inputs]`, `bias` `[outputs, 1]`, `x` `[inputs, N]`.
    """
    built = kernels_for(weight, bias, x)
    if built is None:
        y = torch.addmm(bias, weight, x)
        return functional.gelu(y) if gelu else y
    (outputs, inputs), columns = weight.shape, x.shape[1]
    filled = output(outputs, columns)
    built.call(
        "faultpath_affine",
        lend("weight", weight, outputs, inputs),
        lend("bias", bias, outputs, 1),
        lend("x", x, inputs, columns),
        *(outputs, inputs, columns, int(gelu), filled),
    )
    return filled.tensor


class Affine(nn.Module):
    """`weight @ x + bias` for `x` `[inputs, N]`, initialised as torch's own linear layers are."""

    def __init__(self, inputs: int, outputs: int) -> None:
        super().__init__()
        self.weight = nn.Parameter(torch.empty(outputs, inputs))
        self.bias = nn.Parameter(torch.empty(outputs, 1))

    def forward(self, x: Tensor, gelu: bool = False) -> Tensor:
        """Return `[outputs, N]`, through a Gaussian error linear unit if asked."""
        return affine(self.weight, self.bias, x, gelu)


def draw_weights(module: nn.Module, generator: torch.Generator) -> None:
    """Draw every affine layer of `module` uniformly within one over the root of its inputs."""
    for layer in module.modules():
        if isinstance(layer, Affine):
            bound = 1 / math.sqrt(layer.weight.shape[1])
            for weights in (layer.weight, layer.bias):
                nn.init.uniform_(weights, -bound, bound, generator=generator)


class GatedCell(nn.Module):
    """One step of a gated recurrent unit (Cho et al. 2014, in the form of cuDNN)."""

    def __init__(self, inputs: int, latent: int) -> None:
        super().__init__()
        self.latent = latent
        self.from_input = Affine(inputs, 3 * latent)
        self.from_latent = Affine(latent, 3 * latent)

    def forward(self, x: Tensor, latent: Tensor) -> Tensor:
        """Return the next latent `[latent, N]`."""
        split = 2 * self.latent
        projected = self.from_input(x)
        weight, bias = self.from_latent.weight, self.from_latent.bias
        gates = torch.addmm(projected[:split] + bias[:split], weight[:split], latent).sigmoid()
        reset, update = gates[: self.latent], gates[self.latent :]
        remembered = torch.addmm(bias[split:], weight[split:], latent)
        candidate = torch.addcmul(projected[split:], reset, remembered).tanh()
        return torch.lerp(candidate, latent, update)

    def last(self, sequence: Tensor) -> Tensor:
        """Return the latent `[latent, N]` after a sequence `[T, inputs, N]`, from zero."""
        built = None if torch.is_grad_enabled() else kernels_on(sequence.device)
        steps, inputs, columns = sequence.shape
        if built is None or not self._has_kernel(sequence):
            latent = sequence.new_zeros(self.latent, columns)
            for step in sequence:
                latent = self(step, latent)
            return latent
        gates, entering, kept = 3 * self.latent, self.from_input, self.from_latent
        last = output(self.latent, columns)
        built.call(
            "faultpath_recur",
            lend("weights of the inputs", entering.weight, gates, inputs),
            lend("biases of the inputs", entering.bias, gates, 1),
            lend("weights of the latent", kept.weight, gates, self.latent),
            lend("biases of the latent", kept.bias, gates, 1),
            lend("sequence", sequence, steps, inputs, columns),
            *(steps, inputs, columns, last),
        )
        return last.tensor

    def _has_kernel(self, sequence: Tensor) -> bool:
        layers = (self.from_input, self.from_latent)
        if not (covered(self, GatedCell) and all(covered(layer, Affine) for layer in layers)):
            return False
        inputs = sequence.shape[1]
        if not 0 < inputs <= MOST_INPUTS or self.latent != LATENT:
            size = f"{inputs} inputs and a latent of {self.latent}"
            tell_portable("A recurrent cell", f"its kernel has no room for {size}")
            return False
        return sequence.dtype == torch.float32


class LatentNetwork(nn.Module):
    """Encodes the executed history once, then updates a latent along each candidate.

    At each step the embedded action drives a GRU cell, and an MLP with two hidden layers maps
    (latent, state, action) to the outputs. Features: velocity, rotation matrix, body rate, thrust
    over m~ g, commanded rates (paper, Section IV-A); `conditioning` says how many calibration
    values are appended. They are standardised with the training pool's statistics, which are
    buffers of the checkpoint.
    """

    feature_mean: Tensor
    feature_std: Tensor

    def __init__(self, hidden: int, outputs: int, conditioning: int = 0) -> None:
        super().__init__()
        width = BASE_FEATURES + conditioning
        self.conditioned = conditioning > 0
        self.encoder = GatedCell(width, LATENT)
        self.embed = Affine(ACTION_FEATURES, ACTION_EMBEDDING)
        self.cell = GatedCell(ACTION_EMBEDDING, LATENT)
        self.first = Affine(LATENT + width, hidden)
        self.second = Affine(hidden, hidden)
        self.last = Affine(hidden, outputs)
        self.register_buffer("feature_mean", torch.zeros(width, 1))
        self.register_buffer("feature_std", torch.ones(width, 1))

    def initialise(self, generator: torch.Generator) -> None:
        """Draw all weights; the last layer starts at zero, so that a rollout starts sane."""
        draw_weights(self, generator)
        nn.init.zeros_(self.last.weight)
        nn.init.zeros_(self.last.bias)

    def encode(self, history: Delivered) -> Tensor:
        """Return the history code `[32, *batch]`."""
        past = ("velocity", "attitude", "body_rate", "action", "mass")
        velocity, rotation, rate, command, mass = (history[name, "history"] for name in past)
        conditioning = None
        if self.conditioned:
            conditioning = history["mass", "features"], history["thrust_scale", "features"]
        rows = features(velocity, rotation, rate, command, mass, conditioning)
        sequence = (rows.movedim(1, 0).flatten(2) - self.feature_mean) / self.feature_std
        return self.encoder.last(sequence).unflatten(1, mass.shape)

    def fold(self) -> "FoldedNetwork":
        """Return the network as the horizon loop runs it, with the weights of this moment."""
        inverse = 1 / self.feature_std
        acted = slice(STATE_FEATURES, BASE_FEATURES)
        embed = _folded(
            self.embed.weight, self.embed.bias, self.feature_mean[acted], inverse[acted]
        )
        from_input, from_latent = self.cell.from_input, self.cell.from_latent
        split = 2 * LATENT
        # Columns of the gates: embedded action, one, latent.
        gates = torch.cat(
            (
                from_input.weight[:split],
                from_input.bias[:split] + from_latent.bias[:split],
                from_latent.weight[:split],
            ),
            1,
        )
        latent, weight = self.first.weight[:, :LATENT], self.first.weight[:, LATENT:]
        first = _folded(weight, self.first.bias, self.feature_mean, inverse)
        return FoldedNetwork(
            embed=_with_one(embed),
            gates=gates,
            candidate=torch.cat((from_input.weight[split:], from_input.bias[split:]), 1),
            remembered=torch.cat((from_latent.bias[split:], from_latent.weight[split:]), 1),
            first=_with_one(torch.cat((latent, first), 1)),
            second=_with_one(torch.cat((self.second.weight, self.second.bias), 1)),
            last=torch.cat((self.last.weight, self.last.bias), 1),
        )


@dataclass(frozen=True)
class FoldedNetwork:
    """The step network as plain matrices over raw features.

    Standardisation is folded into the weights, and biases are columns that meet a row of ones, so
    that a layer is one product and no copy. Hidden layers pass the one on in their last row.
    """

    embed: Tensor  # (action, 1) -> (embedding, 1)
    gates: Tensor  # (embedding, 1, latent) -> (reset, update)
    candidate: Tensor  # (embedding, 1) -> candidate's part of the input
    remembered: Tensor  # (1, latent) -> candidate's part of the latent
    first: Tensor  # (latent, features, 1) -> (hidden, 1)
    second: Tensor
    last: Tensor

    def roll(
        self,
        latent: Tensor,
        state: State,
        command: Tensor,
        mass_kg: Tensor,
        conditioning: tuple[Tensor, Tensor] | None = None,
    ) -> tuple[Tensor, Tensor]:
        """Advance a latent `[32, S, 1 or K]` under `command` `[4, S, K]`; return it and outputs."""
        batch = command.shape[1:]
        motion = (state.velocity, state.rotation, state.rate)
        inputs = features(*motion, command, mass_kg, conditioning).flatten(1)
        ones = inputs.new_ones(1, inputs.shape[1])
        latent = latent.expand(LATENT, *batch).flatten(1)

        action = torch.cat((inputs[STATE_FEATURES:BASE_FEATURES], ones))
        known = torch.cat(((self.embed @ action).relu_(), latent))
        reset, update = (self.gates @ known).sigmoid_().split(LATENT)
        split = ACTION_EMBEDDING + 1
        remembered = self.remembered @ known[split - 1 :]
        candidate = torch.addcmul(self.candidate @ known[:split], reset, remembered).tanh_()
        latent = torch.lerp(candidate, latent, update)

        hidden = (self.first @ torch.cat((latent, inputs, ones))).relu_()
        outputs = self.last @ (self.second @ hidden).relu_()
        return latent.unflatten(1, batch), outputs.unflatten(1, batch)


def _folded(weight: Tensor, bias: Tensor, mean: Tensor, inverse_std: Tensor) -> Tensor:
    scaled = weight * inverse_std.T
    return torch.cat((scaled, affine(-scaled, bias, mean)), 1)


def _with_one(weights: Tensor) -> Tensor:
    """Add the row that passes the last input, a one, on."""
    row = torch.zeros_like(weights[:1])
    row[:, -1].fill_(1)
    return torch.cat((weights, row))


def features(
    velocity: Tensor,
    rotation: Tensor,
    rate: Tensor,
    command: Tensor,
    mass_kg: Tensor,
    conditioning: tuple[Tensor, Tensor] | None,
) -> Tensor:
    """Return raw features `[19 or 21, *batch]`; `mass_kg` is the supplied mass.

    `command` `[4, *batch]` decides the batch; the rest may broadcast against it.
    """
    batch = command.shape[1:]
    rows = [
        velocity.expand(3, *batch),
        rotation.flatten(0, 1).expand(9, *batch),
        rate.expand(3, *batch),
        command[:1] / (mass_kg * GRAVITY_MPS2),
        command[1:],
    ]
    if conditioning is not None:
        rows += [value.expand(1, *batch) for value in conditioning]
    return torch.cat(rows)
