"""A process that holds one side and times it when asked, so that sides take turns.

    python -m benchmarks.child MODULE:NAME ARGUMENTS CPU

Each line of standard input is a request and gets one line of JSON on standard output.
"""

import contextlib
import gc
import importlib
import json
import os
import sys
import time
from typing import Any

CLOCKS = {"processor": time.process_time, "wall": time.perf_counter}
"""Processor time counts all threads of the process and nothing of what else the machine does."""


def main() -> None:
    """Build the side and answer requests until standard input ends."""
    where, arguments, cpu = sys.argv[1:]
    # Before anything is imported: thread pools size themselves by what the process may use.
    os.sched_setaffinity(0, {int(cpu)})
    replies = os.fdopen(os.dup(1), "w", buffering=1)
    os.dup2(2, 1)  # whatever a library prints is no reply
    import torch

    torch.set_num_threads(1)
    try:
        module, _, name = where.partition(":")
        side = getattr(importlib.import_module(module), name)(**json.loads(arguments))
        with torch.inference_mode():
            side.prepare()
            side.work()
    except Exception as error:  # the parent reports it and goes on without this side
        print(json.dumps({"error": f"{type(error).__name__}: {error}"}), file=replies)
        return
    print(json.dumps({"amount": side.amount}), file=replies)
    gc.freeze()
    with contextlib.suppress(KeyboardInterrupt), torch.inference_mode():
        for line in sys.stdin:
            print(json.dumps(_reply(side, json.loads(line))), file=replies)


def _reply(side: Any, request: dict[str, Any]) -> dict[str, Any]:
    if request["do"] == "answer":
        return {"answer": [float(value) for value in side.answer()]}
    clock = CLOCKS[request["clock"]]
    seconds: list[float] = []
    for _ in range(request["repeats"]):
        side.prepare()
        start = clock()
        side.work()
        seconds.append(clock() - start)
    return {"seconds": seconds}


if __name__ == "__main__":
    main()
