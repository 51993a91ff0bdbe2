"""Draw what the camera sees in one scene, step by step, under an error.

    python experiments/latent-camera/strip.py docs/images/latent-camera-strip.svg

Scene 000 of `selection`, which decides nothing, with the first training and the exposure at 85 %.
"""

import base64
import struct
import sys
import zlib
from pathlib import Path

import numpy as np
import torch
from study import ROOT

sys.path.insert(0, str(ROOT / "examples"))
import latent_camera as camera

from faultpath.faults import at_readers
from faultpath.loop import Batch
from faultpath.run.attempt import taps_of
from faultpath.run.plan import Treatment

SCENE, ERROR = "selection/000", 0.85
STRIPS = (
    ("plain", "", "plain, no error"),
    ("plain", "@observation", "plain, live picture darker"),
    ("plain", "shared", "plain, both darker"),
    ("rectified", "shared", "rectified, both darker"),
    ("augmented", "shared", "augmented, both darker"),
)
EDGE, GAP, TOP, LEFT = 64, 6, 24, 170  # px


def flown(variant: str, where: str) -> list[tuple[np.ndarray, float]]:
    """Return the pictures of a trial and their exposure; the goal's picture first."""
    system, faults = camera.create(), ()
    readers = system.variants[variant].readers
    if where:
        fault = system.fault(f"exposure:scale={ERROR}{where.removeprefix('shared')}")
        faults = at_readers(fault, readers)
    taps = taps_of(system, Treatment(variant=variant, faults=faults, seed=0), (SCENE,))
    loop = system.loop(variant, seed=0).execute(Batch((SCENE,), 0, system.control_dt_s), taps)
    states = [instant.state for instant in loop]
    pictures = [(states[0][1], ERROR if where == "shared" else 1.0)]
    return pictures + [(state[2], ERROR if where else 1.0) for state in states]


def png(place: np.ndarray, exposure: float) -> str:
    """Return what the camera sees as a PNG, base64."""
    numbers = (torch.tensor([exposure]), torch.ones(1), torch.zeros(1, 2), torch.zeros(1))
    seen = camera.picture(torch.tensor(place).float(), *numbers, "marked")[0, 0].numpy()
    grey = np.clip(255 * seen, 0, 255).astype(np.uint8)
    rows = b"".join(b"\0" + row.tobytes() for row in grey)

    def chunk(kind: bytes, data: bytes) -> bytes:
        return (
            struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
        )

    head = struct.pack(">IIBBBBB", *grey.shape[::-1], 8, 0, 0, 0, 0)
    parts = ((b"IHDR", head), (b"IDAT", zlib.compress(rows, 9)), (b"IEND", b""))
    return base64.b64encode(
        b"\x89PNG\r\n\x1a\n" + b"".join(chunk(*part) for part in parts)
    ).decode()


def main() -> None:
    """Write the strips."""
    steps = range(0, camera.STEPS + 1, 2)
    heads = ["goal", *(f"step {step}" for step in steps)]
    lefts = [LEFT + (EDGE + GAP) * i + (GAP * 2 if i else 0) for i in range(len(heads))]
    texts = [
        f'<text x="{left + EDGE / 2}" y="{TOP - 8}" text-anchor="middle">{head}</text>'
        for left, head in zip(lefts, heads, strict=True)
    ]
    for row, (variant, where, title) in enumerate(STRIPS):
        goal, *live = flown(variant, where)
        top = TOP + row * (EDGE + GAP)
        texts.append(f'<text x="0" y="{top + EDGE / 2 + 4}">{title}</text>')
        for left, picture in zip(lefts, (goal, *(live[step] for step in steps)), strict=True):
            texts.append(
                f'<image x="{left}" y="{top}" width="{EDGE}" height="{EDGE}" '
                f'style="image-rendering: pixelated" href="data:image/png;base64,{png(*picture)}"/>'
            )
    width, height = lefts[-1] + EDGE, TOP + len(STRIPS) * (EDGE + GAP)
    style = "text { font: 12px sans-serif; fill: #777 }"
    Path(sys.argv[1]).write_text(
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}">'
        f"<style>{style}</style>{''.join(texts)}</svg>\n"
    )


if __name__ == "__main__":
    main()
