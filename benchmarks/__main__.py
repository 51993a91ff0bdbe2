"""Measure; `tools/documents.py` makes the page of it.

python -m benchmarks [--only NAME ...]   what is not asked for keeps its numbers
"""

import argparse
import sys
import time

from benchmarks import page
from benchmarks.results import RESULTS, Results, load, save


def measure(only: list[str]) -> None:
    """Take comparisons one after the other; results are saved after each."""
    from benchmarks import ablation, commands, loop, machine, parts, planning, scaling
    from benchmarks.comparison import unmeasured

    modules = (planning, loop, ablation, parts, scaling, commands)
    known = {each.name: each for module in modules for each in module.COMPARISONS}
    unknown = [name for name in only if name not in known]
    if unknown:
        sys.exit(
            f"benchmarks: there is no comparison '{unknown[0]}'; choose of {', '.join(known)}."
        )
    here = machine.describe()
    results = load() if RESULTS.exists() else Results(machine=here, records=(), curves=())
    for name in only or known:
        start = time.monotonic()
        try:
            found = known[name].run()
            records, curves = found.records, found.curves
        except Exception as error:  # one that fails must not lose the others
            reason = f"{type(error).__name__}: {error}"
            records, curves = [unmeasured(name, name, reason)], ()
        results = results.replaced(here, name, records, curves, apart=bool(only))
        save(results)
        print(f"{name}: {time.monotonic() - start:.0f} s", flush=True)
        for record in records:
            print("   ", page.told(record), flush=True)


def main() -> int:
    """Do what was asked; return the exit status."""
    parser = argparse.ArgumentParser(prog="benchmarks", description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--only", nargs="+", default=[], metavar="NAME", help="these comparisons")
    measure(parser.parse_args().only)
    return 0


if __name__ == "__main__":
    sys.exit(main())
