"""One side of a comparison: work that pyperf times in a process of its own, with one thread.

python -m benchmarks.side MODULE:FUNCTION [pyperf's options]
"""

import importlib
import sys
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import pyperf


@dataclass
class Side:
    """Work that is timed."""

    work: Callable[[], object]
    amount: float = 1.0
    """Units of work in one call; a rate is this over the seconds of a call."""


def check_same(found: Any, ours: Any, tolerance: float) -> None:
    """Exit where a side gives other numbers than ours: what it does is then other work."""
    apart = float(np.max(np.abs(np.asarray(found) - np.asarray(ours))))
    if not apart <= tolerance:
        sys.exit(f"its numbers differ from ours by {apart:.3g}")


def main() -> None:
    """Build the side that the first argument names, and time it."""

    def pass_on(command: list[str], args: Any) -> None:
        command.append(args.side)

    runner = pyperf.Runner(program_args=("-m", "benchmarks.side"), add_cmdline_args=pass_on)
    runner.argparser.add_argument("side")
    args = runner.parse_args()
    if not args.worker:  # the parent only starts workers
        runner.bench_func(args.side, lambda: None)
        return
    import torch

    torch.set_num_threads(1)
    module, _, function = args.side.partition(":")
    with torch.inference_mode():
        side: Side = getattr(importlib.import_module(module), function)()
        runner.metadata["amount"] = side.amount
        runner.bench_func(args.side, side.work)


if __name__ == "__main__":
    main()
