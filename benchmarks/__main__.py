"""Measure; `tools/documents.py` makes the page of it.

python -m benchmarks [--only NAME ...]   what is not asked for keeps its numbers
"""

import argparse
import sys
import time

from benchmarks import machine, page
from benchmarks.comparison import Effort
from benchmarks.quiet import Others
from benchmarks.results import RESULTS, Record, Results, load, save
from benchmarks.table import COMPARISONS

TRY = Effort(share=0.02)


def measure(only: list[str], effort: Effort, keep: bool) -> None:
    """Take comparisons one after the other; what is kept is saved after each."""
    here, others = machine.describe(), Others()
    results = load() if RESULTS.exists() else Results(machine=here)
    for name in only or COMPARISONS:
        start, comparison = time.monotonic(), COMPARISONS[name]
        found = list(comparison.take(effort))
        if keep:
            here = here.model_copy(update={"others": others.share()})
            results = results.replaced(here, name, found, bool(only), comparison.edition)
            save(results)
        print(f"{name}: {time.monotonic() - start:.0f} s", flush=True)
        for each in found:
            if isinstance(each, Record):
                print("   ", page.told(each), flush=True)


def main() -> int:
    """Do what was asked; return the exit status."""
    parser = argparse.ArgumentParser(prog="benchmarks", description=(__doc__ or "").split("\n")[0])
    parser.add_argument(
        "--only", nargs="+", default=[], metavar="NAME", choices=COMPARISONS,
        help=f"these comparisons, of {', '.join(COMPARISONS)}",
    )  # fmt: skip
    parser.add_argument("--try", dest="tried", action="store_true", help="a little, kept nowhere")
    asked = parser.parse_args()
    measure(asked.only, TRY if asked.tried else Effort(), keep=not asked.tried)
    return 0


if __name__ == "__main__":
    sys.exit(main())
