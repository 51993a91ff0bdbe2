"""Measure how latent states move under an error of the camera, and whether they move together.

    python experiments/latent-camera/latents.py DESIGN.yaml

Of 400 places, seed by seed: how far an error moves a latent state, in moves by one action of 4 px;
which part of that is one common move of all places, which a distance of two of them does not feel;
and how far from a goal the place is whose latent state is nearest to the goal's. Flies nothing.
"""

import argparse
import json
import sys
from pathlib import Path

import numpy as np
import torch
from study import ROOT, Design

sys.path.insert(0, str(ROOT / "examples"))
import latent_camera as camera

from faultpath.trials import load_system


def measured(model, prepared, rooms: str, told: dict) -> dict[str, float]:
    """Return what an error of the camera does to a model's latent states."""
    rng = np.random.default_rng(0)
    places = camera.drawn(rng, 400)
    angle = rng.uniform(0, 2 * np.pi, 400)
    beside = camera.moved(places, np.stack([np.cos(angle), np.sin(angle)], axis=1))

    def latents(where, error):
        numbers = {"exposure": 1.0, "gamma": 1.0, "shift": (0.0, 0.0)} | error
        numbers = (torch.tensor(each).expand(400, *np.shape(each)) for each in numbers.values())
        seen = camera.picture(torch.tensor(where).float(), *numbers, rooms)
        with torch.no_grad():
            return torch.cat([model.encode(prepared(one)) for one in seen.split(1)])

    right, wrong = latents(places, {}), latents(places, told)
    moved = wrong - right
    action = (latents(beside, {}) - right).norm(dim=1).mean()
    apart = torch.cdist(torch.tensor(places), torch.tensor(places))

    def missed(live, goal) -> float:
        return apart[torch.cdist(goal, live).argmin(dim=1), torch.arange(400)].mean().item()

    return {
        "moved": (moved.norm(dim=1).mean() / action).item(),
        "common": (moved.mean(dim=0).square().sum() / moved.square().sum(dim=1).mean()).item(),
        "missed_observation_px": missed(wrong, right),
        "missed_shared_px": missed(wrong, wrong),
    }


def main() -> None:
    """Measure every variant that is fitted, under every fault of a design."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("design", type=Path)
    parser.add_argument("--out", type=Path, default=Path("runs/latent-camera-study"))
    asked = parser.parse_args()
    design = Design.read(asked.design)
    torch.set_num_threads(1)
    system, found = load_system(design.spec), []
    for variant in (design.baseline, *design.repairs):
        fitted = "plain" if variant.startswith("rectified") else variant
        names = [system.folder / f"{system.rooms}-{fitted}-{s}.safetensors" for s in design.seeds]
        if not all(map(Path.is_file, names)):
            continue
        for name, text in design.faults.items():
            fault = system.fault(text)
            change = getattr(fault.intervention, "factor", None) or fault.intervention.by
            told = {fault.channel: change}
            each = []
            for seed in design.seeds:
                eye = system.modules(variant, seed)[0]
                each.append(measured(eye.model, eye.prepared, system.rooms, told))
            mean = {key: float(np.mean([one[key] for one in each])) for key in each[0]}
            found.append({"variant": variant, "fault": name, **mean})
            print(found[-1], flush=True)
    asked.out.mkdir(parents=True, exist_ok=True)
    file = asked.out / f"{asked.design.stem}-latents.json"
    file.write_text(json.dumps(found, indent=1) + "\n")


if __name__ == "__main__":
    main()
