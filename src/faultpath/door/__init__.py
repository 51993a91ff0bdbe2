"""The front door: what `import faultpath` offers, and what the command line calls.

A call flies, decides, writes a run folder and returns what came out. It leaves threads, environment
and random state of its caller as they were. `check` and `trace` are offered here.
"""

from faultpath.door.reviewing import check, trace

__all__ = ["check", "trace"]
