"""Make a library of scenes from a seed: python make.py mine.json --seed 7 --count 100."""

import argparse
import sys
from pathlib import Path

from faultpath_quadrotor.scenes.library import FROZEN, SceneLibrary, as_text, load_library
from generate import generate_scene

FROZEN_SEEDS = {
    "training": (101, 100),
    "selection": (202, 100),
    "held-out": (303, 100),
    "confirmation": (20261126, 300),
    "decision": (20261129, 400),
}
"""Seed and number of scenes of the libraries of the package."""


def draw_library(name: str, seed: int, count: int) -> SceneLibrary:
    """Return `count` new scenes; the same name, seed and count give the same scenes."""
    return SceneLibrary.of(name, tuple(generate_scene(name, index, seed) for index in range(count)))


def main() -> None:
    """Write a library, or make the frozen ones again and compare."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("file", type=Path, nargs="?", help="to write; its stem names the library")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--count", type=int, default=100)
    parser.add_argument("--check", action="store_true", help="make the frozen libraries again")
    options = parser.parse_args()
    if options.check:
        for name, size in FROZEN_SEEDS.items():
            same = draw_library(name, *size).content_hash == load_library(name).content_hash
            print(name, "is the same" if same else "DIFFERS")
        return
    if options.file is None or options.file.exists() or options.file.stem in FROZEN:
        sys.exit("name a file that does not exist, by another name than the frozen libraries")
    options.file.write_text(as_text(draw_library(options.file.stem, options.seed, options.count)))
    load_library(options.file)  # what cannot be flown is refused now


if __name__ == "__main__":
    main()
