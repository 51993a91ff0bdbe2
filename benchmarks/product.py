"""How many large matrix products one process makes a second: what the machine itself can do.

python -m benchmarks.product SECONDS
"""

import subprocess
import sys
import time

import torch

SIZE = 1024


def main() -> None:
    """Multiply for some seconds and print the rate."""
    torch.set_num_threads(1)
    one, other, out = torch.ones(SIZE, SIZE), torch.ones(SIZE, SIZE), torch.empty(SIZE, SIZE)
    start, count = time.perf_counter(), 0
    while time.perf_counter() - start < float(sys.argv[1]):
        torch.mm(one, other, out=out)
        count += 1
    print(count / (time.perf_counter() - start))


def together(processes: int, seconds: float) -> float:
    """Return the products a second of some processes that run at the same time."""
    command = [sys.executable, "-m", "benchmarks.product", str(seconds)]
    running = [
        subprocess.Popen(command, stdout=subprocess.PIPE, text=True) for _ in range(processes)
    ]
    return sum(float(process.communicate()[0]) for process in running)


if __name__ == "__main__":
    main()
