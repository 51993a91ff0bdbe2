"""How much of the processor other work took while something was measured (Linux)."""

import os
import resource
from pathlib import Path

QUIET = 0.02
"""Share of the processor's time that other work may take of a measurement on a quiet machine."""

_STAT = Path("/proc/stat")


class Others:
    """Share of the processor that others take from here on (Linux)."""

    def __init__(self) -> None:
        self._busy, self._all = _ticks()
        self._own = _own_s()

    def share(self) -> float:
        """Return processor time of others since, over that of all cores."""
        taken, there = _ticks()
        own = (_own_s() - self._own) * os.sysconf("SC_CLK_TCK")
        return max(0.0, (taken - self._busy - own) / max(1.0, there - self._all))


def busy(share: float) -> str:
    """Return in a sentence what others took of the processor meanwhile."""
    said = f"ther work took {100 * share:.1f} % of the processor's time meanwhile."
    return f"O{said}" if share <= QUIET else f"**The machine was busy**: o{said}"


def _ticks() -> tuple[float, float]:
    line = _STAT.read_text("ascii").partition("\n")[0]
    user, nice, system, idle, waiting, *interrupts = (float(word) for word in line.split()[1:])
    taken = user + nice + system + sum(interrupts[:2])
    return taken, taken + idle + waiting


def _own_s() -> float:
    used = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(each.ru_utime + each.ru_stime for each in used)
