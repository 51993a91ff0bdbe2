"""A world model of one's own: fitted to flights of the quadrotor, then audited against `wm-a`.

    python examples/own_model.py --seed 0
    faultpath audit quadrotor --library selection --clearance true --scenes 20 \
        --baseline wm-a --repair examples/own_model.py:create --fault calibration=+0.1

It is a kinematic integrator whose accelerations a small network corrects, as in `wm-a`, but without
the memory: it sees the present only. `docs/bring-your-own-model.md` goes through this file.
"""

import argparse
import time
from pathlib import Path

import torch
from faultpath_quadrotor.predictors import KinematicIntegrator, Predictor, PredictorInputs
from faultpath_quadrotor.predictors.kinematic import Residual
from faultpath_quadrotor.predictors.network import Affine, draw_weights
from faultpath_quadrotor.state import State
from faultpath_quadrotor.training.flight import collect
from faultpath_quadrotor.training.predictor_task import error, scales
from faultpath_quadrotor.training.windows import correct, predict, windows_of
from safetensors.torch import load_file, save_file
from torch import Tensor, nn

from faultpath import UserError

FOLDER = Path("runs/own-model").absolute()
BATCH, LEARNING_RATE, HIDDEN = 256, 3e-3, 48


class OwnModel(nn.Module, Predictor):
    """Body-frame velocity, body rate and command in; corrections of two accelerations out."""

    reads = frozenset({"initial_state", "trim", "dynamics", "normalise_thrust"})

    def __init__(self) -> None:
        super().__init__()
        self.kinematics = KinematicIntegrator(wind=False)
        self.first = Affine(10, HIDDEN)
        self.second = Affine(HIDDEN, HIDDEN)
        self.last = Affine(HIDDEN, 6)
        self.data_files = sorted(FOLDER.glob("*.safetensors"))

    def begin(self, inputs: PredictorInputs) -> object:
        """Once a replan: what stays the same over the horizon, batch `[S, 1]`."""
        return self.kinematics.begin(inputs), inputs["mass", "normalise_thrust"]

    def step(self, state: State, command: Tensor, memory: object) -> tuple[State, object]:
        """Once a horizon step, for scenes and candidates: commands are `[4, S, K]`."""
        constants, mass_kg = memory
        batch = command.shape[1:]
        to_body = state.rotation.transpose(0, 1)
        velocity = (to_body * state.velocity).sum(1)
        features = [velocity / 3, state.rate / 3, command[:1] / (10 * mass_kg), command[1:] / 3]
        x = torch.cat([feature.expand(-1, *batch) for feature in features]).flatten(1)
        x = self.last(torch.relu(self.second(torch.relu(self.first(x))))).unflatten(1, batch)
        linear = (state.rotation * (8 * torch.tanh(x[:3]))).sum(1)
        correction = Residual(linear_mps2=linear, angular_radps2=40 * torch.tanh(x[3:]))
        return self.kinematics.advance(state, command, constants, correction), memory


def create(seed: int | None) -> Predictor:
    """Return the model of a seed; without one, a model of which only the reads count."""
    model = OwnModel()
    if seed is not None:
        path = weights(seed)
        if not path.is_file():
            raise UserError(f"no weights in {path}: python {__file__} --seed {seed} fits them.")
        model.load_state_dict(load_file(path))
    return model.eval()


def weights(seed: int) -> Path:
    """Return where the weights of a seed stand."""
    return FOLDER / f"weights-{seed}.safetensors"


def fit(seed: int, episodes: int, epochs: int) -> None:
    """Fit on flights of the training pool, by the error of the model's own 20-step rollouts."""
    pools = collect(FOLDER / "data", ["nominal"], workers=0, episodes={"nominal": episodes})
    training, validation = windows_of(pools["nominal"]).split()
    scale = scales(training)
    random = torch.Generator().manual_seed(seed)
    model = OwnModel()
    draw_weights(model, random)
    nn.init.zeros_(model.last.weight)  # so that it starts as the integrator alone
    nn.init.zeros_(model.last.bias)
    optimiser = torch.optim.Adam(model.parameters(), LEARNING_RATE)
    schedule = torch.optim.lr_scheduler.CosineAnnealingLR(optimiser, epochs)
    for _ in range(epochs):
        for index in torch.randperm(len(training), generator=random).split(BATCH):
            batch = training.take(index)
            loss = error(list(predict(model, batch, correct(model, batch))), batch, scale)
            optimiser.zero_grad()
            loss.backward()
            nn.utils.clip_grad_norm_(model.parameters(), 1.0)
            optimiser.step()
        schedule.step()
    save_file(model.state_dict(), weights(seed))
    predictors = {"integrator alone": KinematicIntegrator(wind=False), "own model": model}
    for name, predictor in predictors.items():
        with torch.no_grad():
            *_, end = predict(predictor, validation, correct(predictor, validation))
        missed = (end.position[..., 0] - validation.position[:, -1]).norm(dim=0)
        print(f"{name}: median error after 1 s {missed.median():.3f} m")


def main() -> None:
    """Fit the model of one seed."""
    parser = argparse.ArgumentParser(description="Fit the example's model.")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--episodes", type=int, default=1500)
    parser.add_argument("--epochs", type=int, default=20)
    options = parser.parse_args()
    torch.set_num_threads(1)
    started = time.monotonic()
    fit(options.seed, options.episodes, options.epochs)
    print(f"Fitted in {time.monotonic() - started:.0f} s; weights in {weights(options.seed)}")


if __name__ == "__main__":
    main()
