"""What version 0.1 took and this one takes no more: whoever writes it is told what stands for it.

Nothing here is accepted; a name only leads to a sentence. It goes when 0.1 is forgotten.
"""

import re
from collections.abc import Callable, Mapping
from functools import wraps
from typing import Any, TypeVar

_Class = TypeVar("_Class", bound=type)

SINCE = "since version 0.2"

_METRIC = "give it in metrics={{'{0}': ...}} and declare it in the system's `metrics`"
_NO_MEMORY = "faultpath limits no memory; let the shell do it, with `ulimit -v`"
_NO_SHARE = "every run folder keeps its own trials; leave it out"
_NO_FACTORIAL = "give each combination as a fault, its parts joined by `&`"
_ONE_PLATFORM = "one platform ships; leave it out"

OPTIONS: Mapping[str, Mapping[str, str]] = {
    "audit": {
        "memory_limit": _NO_MEMORY,
        "share": _NO_SHARE,
        "factorial": _NO_FACTORIAL,
        "after": "ask for more scenes in the same folder; the record says what was decided before",
    },
    "check": {"time_limit": "leave it out, or set `time_limit_s` of the system"},
    "map": {"share": _NO_SHARE},
    "plan": {
        "factorial": _NO_FACTORIAL,
        "faults": "say fault",
        "modules": "say module",
        "workers": "a plan runs in one process; leave it out",
    },
    "replay": {
        "out": "say --export FILE.mcap",
        "speed": "the report's player sets its own speed",
    },
    "reproduce": {
        "platform": _ONE_PLATFORM,
        "library": "say `faultpath audit SYSTEM --library`",
    },
    "train": {
        "force": "delete the folder of the model to have it fitted anew",
        "tensorboard": "see the curves on the model cards",
        "platform": _ONE_PLATFORM,
    },
    "trace": {"svg": "see the drawing of the interface in the report of an audit"},
}
"""Options by verb, written with `_` and without a unit: `memory_limit_gib` is `memory_limit`."""

VERBS: Mapping[str, str] = {
    "claims": "say `faultpath reproduce --judge`",
    "compare": "say `faultpath report FOLDER FOLDER`",
    "interface": "say `faultpath trace SYSTEM`",
    "probe": "say `faultpath plan SYSTEM`, which probes what it ranks",
    "runs": "say `faultpath report FOLDER`, for each folder",
    "scenes": "write the file of a library, and name it with --library",
    "selfcheck": "say `make statistics` in a checkout",
}

MODULES: Mapping[str, str] = {
    "faultpath.door": "faultpath",
    "faultpath.errors": "faultpath, as in faultpath.UserError",
    "faultpath.quadrotor": "faultpath_quadrotor, which is installed beside faultpath",
    "faultpath.record": "faultpath.decisions",
    "faultpath.repairs": "faultpath.learning",
    "faultpath.reproduce": "faultpath_quadrotor.reproduce",
    "faultpath.streams": "faultpath, as in faultpath.generator",
    "faultpath.taps": "faultpath.loop",
}
"""Modules that users imported, and where their names are now."""

_NAMES: Mapping[str, Mapping[str, str]] = {
    "DecisionRecord": {
        "verdict": "read `headline`, `sentences` and `would_change` of the record",
        "factorial": _NO_FACTORIAL,
    },
    "Fault": {
        "striking": "say aimed_at",
        "intermittence": "give onset_step and duration_steps",
        "own_cause": "give cause, and loading for how far it is shared",
    },
    "GymnasiumPlant": {"vector": "leave it out; every scene has an environment of its own"},
    "Outcome": {
        "struck_steps": "say faulted_steps",
        **{each: _METRIC.format(each) for each in ("terminal_distance_m", "min_clearance_m")},
    },
    "Progress": {each: _METRIC.format(each) for each in ("terminal_distance_m", "min_clearance_m")},
    "Run": {"trials": "say table().to_pandas()"},
}
"""Arguments and attributes, by class."""


def of_option(verb: str, name: str) -> str:
    """Return what stands for an option of a verb or of its function; empty for none of 0.1."""
    verb = verb.partition(" ")[0].removeprefix("reversal_")
    known = re.sub(r"_(s|gib)$", "", name.removeprefix("--").replace("-", "_"))
    instead = OPTIONS.get(verb, {}).get(known, "")
    return f"{name} is gone {SINCE}: {instead}" if instead else ""


def of_verb(name: str) -> str:
    """Return what stands for a verb; empty for none of 0.1."""
    return f"'{name}' is gone {SINCE}: {VERBS[name]}" if name in VERBS else ""


def of_module(name: str) -> str:
    """Return where the names of a module are now; empty for none of 0.1."""
    top = ".".join(name.split(".")[:2])
    return f"{SINCE} it is {MODULES[top]}" if top in MODULES else ""


def tells_renames(cls: _Class) -> _Class:
    """Let a class answer an argument or an attribute of version 0.1 with what stands for it now."""
    holder = cls.__name__
    names, made = _NAMES[holder], cls.__init__
    found: Callable[[Any, str], Any] | None = getattr(cls, "__getattr__", None)

    @wraps(made)
    def __init__(self: Any, *args: Any, **given: Any) -> None:
        for name in names.keys() & given.keys():
            raise TypeError(f"{holder} takes no {name} {SINCE}: {names[name]}")
        made(self, *args, **given)

    def __getattr__(self: Any, name: str) -> Any:
        if name in names:
            raise AttributeError(f"{holder} has no {name} {SINCE}: {names[name]}")
        if found is not None:
            return found(self, name)
        raise AttributeError(f"{holder!r} object has no attribute {name!r}")

    type.__setattr__(cls, "__init__", __init__)
    type.__setattr__(cls, "__getattr__", __getattr__)
    return cls
