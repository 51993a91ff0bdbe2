"""Measure, write the page, or check that it is up to date.

python -m benchmarks run [--only NAME ...]   measure; what is not asked for keeps its numbers
python -m benchmarks page                    write docs/performance.md and its pictures
python -m benchmarks check                   exit 1 when they are not what results.json gives
"""

import argparse
import sys
import time

from benchmarks import page
from benchmarks.results import RESULTS, ROOT, Results, load, save


def measure(only: list[str]) -> None:
    """Take comparisons one after the other; results are saved after each."""
    from benchmarks import commands, loop, machine, parts, planning, scaling
    from benchmarks.comparison import unmeasured

    modules = (planning, loop, parts, scaling, commands)
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
        results = results.replaced(here, name, records, curves)
        save(results)
        print(f"{name}: {time.monotonic() - start:.0f} s", flush=True)
        for record in records:
            print("   ", page.line(record), flush=True)


def main() -> int:
    """Do what was asked; return the exit status."""
    parser = argparse.ArgumentParser(prog="benchmarks", description=(__doc__ or "").split("\n")[0])
    verbs = parser.add_subparsers(dest="verb", required=True)
    run = verbs.add_parser("run", help="measure")
    run.add_argument("--only", nargs="+", default=[], metavar="NAME", help="these comparisons")
    verbs.add_parser("page", help="write docs/performance.md")
    verbs.add_parser("check", help="exit 1 when docs/performance.md is stale")
    asked = parser.parse_args()
    if asked.verb == "run":
        measure(asked.only)
        return 0
    made = page.files(load())
    if asked.verb == "page":
        for path, text in made.items():
            path.write_text(text, "utf-8")
        return 0
    stale = [
        path for path, text in made.items() if not path.is_file() or path.read_text("utf-8") != text
    ]
    for path in stale:
        print(f"{path.relative_to(ROOT)} is not what results.json gives: run make bench-page.")
    return 1 if stale else 0


if __name__ == "__main__":
    sys.exit(main())
