"""One side of a comparison: work that pyperf times in a process of its own, with one thread.

python -m benchmarks.side MODULE:FUNCTION[:SCENES] [pyperf's options]
"""

import importlib
import sys
from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
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
    note: str = ""
    """Software that runs it, where that differs from the other sides."""


def check_same(theirs: Any, ours: Any, tolerance: float) -> None:
    """Exit where a side gives other numbers than ours: then it does other work."""
    apart = float(np.max(np.abs(np.asarray(theirs) - np.asarray(ours))))
    if not apart <= tolerance:
        sys.exit(f"its numbers differ from ours by {apart:.3g}")


def one_thread() -> AbstractContextManager[object]:
    """Hold torch to one thread and no gradients, where the side's environment has torch."""
    try:
        import torch
    except ModuleNotFoundError:
        return nullcontext()
    torch.set_num_threads(1)
    return torch.inference_mode()


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
    module, function, *scenes = args.side.split(":")
    with one_thread():
        side: Side = getattr(importlib.import_module(module), function)(*map(int, scenes))
        runner.metadata["amount"] = side.amount
        if side.note:
            runner.metadata["note"] = side.note
        runner.bench_func(args.side, side.work)


if __name__ == "__main__":
    main()
