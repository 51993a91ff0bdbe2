"""A trained policy balances Gymnasium's cart-pole, and a guard overrides it where the pole leans.

Two modules read the same encoder of the pole:

    policy      a network that Stable-Baselines3 trained, run by ONNX Runtime or by
                Stable-Baselines3 itself; it chooses to push the cart left or right
    guard       pushes towards the lean where the pole will soon lean too far

Baseline `plain`: the policy alone. Repair `guarded`: the guard has the last word. The fault: the
encoder freezes for 0.3 s.

    faultpath audit examples/guarded_policy.py:create --baseline plain --repair guarded \
        --fault pole:freeze,onset_s=2,for_s=0.3

`--runtime sb3` runs the same network by Stable-Baselines3. `python examples/guarded_policy.py`
trains it again, in a minute and a half, and writes both of its files.
"""

from pathlib import Path
from typing import Annotated, Literal

import numpy as np

from faultpath.system import ComposedSystem, GymnasiumPlant, Module, Parts, row_wise, writes

FILES = Path(__file__).with_suffix("")
ONNX, WEIGHTS = FILES / "policy.onnx", FILES / "policy.safetensors"
MODEL = {"policy": "MlpPolicy", "env": "CartPole-v1", "policy_kwargs": {"net_arch": [32, 32]}}
"""Architecture of the network; its weights are in both files."""


# --- onnx ---
def by_onnx_runtime() -> Module:
    import onnxruntime

    options = onnxruntime.SessionOptions()
    options.intra_op_num_threads = 1  # the audit's processes share the cores already
    session = onnxruntime.InferenceSession(ONNX.read_bytes(), options)
    chosen = row_wise(lambda observation: session.run(None, {"observation": observation})[0])

    @writes("choice")
    def policy(cart, pole):
        return chosen(np.hstack([cart, pole]).astype(np.float32))

    return policy


# --- sb3 ---
def by_stable_baselines3() -> Module:
    from safetensors.torch import load
    from stable_baselines3 import PPO

    model = PPO(**MODEL, device="cpu")  # or PPO.load("yours.zip"), a file that you trust
    model.policy.load_state_dict(load(WEIGHTS.read_bytes()))
    chosen = row_wise(lambda observation: model.predict(observation, deterministic=True)[0])

    @writes("choice")
    def policy(cart, pole):
        return chosen(np.hstack([cart, pole]))

    return policy


# --- guard ---
@writes("safe_choice")
def guard(choice, pole):
    soon = pole[:, 0] + 0.1 * pole[:, 1]  # where it leans in 0.1 s, rad
    return np.where(abs(soon) > 0.1, (soon > 0).astype(choice.dtype), choice)


# --- system ---
def create(
    runtime: Annotated[Literal["onnx", "sb3"], "What runs the policy."] = "onnx",
) -> ComposedSystem:
    policy = by_onnx_runtime() if runtime == "onnx" else by_stable_baselines3()
    plant = GymnasiumPlant(
        "CartPole-v1",
        observes={"cart": slice(0, 2), "pole": slice(2, 4)},
        action="push",
        dt_s=0.02,
        succeeded=lambda episode: not episode.terminated,
    )
    return ComposedSystem(
        "guarded_policy",
        plant,
        variants={
            "plain": Parts("The policy alone.", [policy]),
            "guarded": Parts("The guard may override the policy.", [guard, policy]),
        },
        units={
            "cart": {"unit": "m, m/s", "components": ("place", "speed")},
            "pole": {"unit": "rad, rad/s", "components": ("angle", "rate")},
            "choice": "1",
            "safe_choice": "1",
        },
        channels={"push": ["choice", "safe_choice"]},
        data_files=[ONNX if runtime == "onnx" else WEIGHTS],
    )


# --- training ---
def train(steps: int = 30_000) -> None:
    """Train the network and write it for both of its users."""
    import torch
    from safetensors.torch import save_file
    from stable_baselines3 import PPO

    class Choice(torch.nn.Module):
        def __init__(self, policy):
            super().__init__()
            self.policy = policy

        def forward(self, observation):
            return self.policy(observation, deterministic=True)[0]

    model = PPO(
        **MODEL, seed=0, device="cpu", n_steps=256, batch_size=64, learning_rate=1e-3
    ).learn(steps)
    FILES.mkdir(exist_ok=True)
    save_file(model.policy.state_dict(), WEIGHTS)
    torch.onnx.export(
        Choice(model.policy),
        (torch.zeros(1, 4),),
        str(ONNX),
        input_names=["observation"],
        output_names=["choice"],
        dynamic_axes={"observation": {0: "scene"}, "choice": {0: "scene"}},
        dynamo=False,  # the exporter that needs no further package
    )


if __name__ == "__main__":
    train()
