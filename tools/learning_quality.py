"""Measure the trained models on validation windows, for `docs/learning-quality.md`.

python tools/learning_quality.py --data data   measure, into docs/reference
"""

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

import torch
from learning_blocks import result_path

from faultpath.errors import UserError
from faultpath.quadrotor.training.quality import measure
from faultpath.store import atomic


def main(arguments: Sequence[str] | None = None) -> int:
    """Measure; return the exit status."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--data", type=Path, default=Path("data"), help="folder of the pools")
    parser.add_argument("--checkpoints", type=Path, help="folder; by default the package's")
    asked = parser.parse_args(arguments)
    torch.set_num_threads(1)
    try:
        quality = measure(asked.data, asked.checkpoints, lambda text: print(text, flush=True))
    except UserError as error:
        print(f"learning_quality.py: {error}", file=sys.stderr)
        return 2
    atomic.write(result_path(), quality.encode())
    print(f"Missing: {', '.join(quality.missing) or 'nothing'}.")
    return 0


if __name__ == "__main__":
    sys.exit(main())
