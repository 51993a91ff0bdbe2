"""Measure how latent states move under an error of the camera, and whether they move together.

    python experiments/latent-camera/latents.py DESIGN.yaml

Of 400 places, seed by seed: how far an error moves the latent state of the live picture, in moves
by one action; which part of that is one common move of all places, which a distance of two of them
does not feel; how far from 400 goals the places are whose live latent states are nearest to the
goals', without an error, with it in the live picture and in both; and how far an imagined action
ends from the latent state that follows, without and with the error. Flies nothing.
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

from faultpath.run.registry import load_system


def measured(observation, goal, rooms: str, error: dict) -> dict[str, float]:
    """Return what an error of the camera does to the latent states of two modules."""
    model, rng = observation.model, np.random.default_rng(0)
    places, goals = camera.drawn(rng, 400), camera.drawn(rng, 400)
    angles = rng.uniform(0, 2 * np.pi, 400)
    actions = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    apart = torch.cdist(torch.tensor(goals), torch.tensor(places))

    def latents(eye, where, wrong=None):
        numbers = {"exposure": 1.0, "gamma": 1.0, "shift": (0.0, 0.0), "smear": 0.0} | (wrong or {})
        numbers = (torch.tensor(each).expand(400, *np.shape(each)) for each in numbers.values())
        seen = camera.picture(torch.tensor(where).float(), *numbers, rooms)
        with torch.no_grad():
            return torch.cat([model.encode(eye.prepared(one)) for one in seen.split(1)])

    def missed(wrong_live, wrong_goal) -> float:
        live, target = latents(observation, places, wrong_live), latents(goal, goals, wrong_goal)
        return apart[torch.arange(400), torch.cdist(target, live).argmin(dim=1)].mean().item()

    def imagined(wrong) -> float:
        live = latents(observation, places, wrong)
        following = latents(observation, camera.moved(places, actions), wrong)
        with torch.no_grad():
            ahead = model.imagine(live, torch.tensor(actions).float()[:, None])[:, 0]
        return ((ahead - following).norm(dim=1).mean() / action).item()

    right = latents(observation, places)
    action = (latents(observation, camera.moved(places, actions)) - right).norm(dim=1).mean()
    moved = latents(observation, places, error) - right
    return {
        "moved": (moved.norm(dim=1).mean() / action).item(),
        "common": (moved.mean(dim=0).square().sum() / moved.square().sum(dim=1).mean()).item(),
        "missed_correct_px": missed(None, None),
        "missed_observation_px": missed(error, None),
        "missed_shared_px": missed(error, error),
        "imagined_correct": imagined(None),
        "imagined_error": imagined(error),
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
            (fault,) = system.fault(text)
            change = getattr(fault.intervention, "factor", None) or fault.intervention.by
            told = {fault.channel: change}
            rows = []
            for seed in design.seeds:
                observation, goal, _ = system.modules(variant, seed)
                rows.append(measured(observation, goal, system.rooms, told))
            mean = {key: float(np.mean([row[key] for row in rows])) for key in rows[0]}
            found.append({"variant": variant, "fault": name, **mean})
            print(found[-1], flush=True)
    asked.out.mkdir(parents=True, exist_ok=True)
    file = asked.out / f"{asked.design.stem}-latents.json"
    file.write_text(json.dumps(found, indent=1) + "\n")


if __name__ == "__main__":
    main()
