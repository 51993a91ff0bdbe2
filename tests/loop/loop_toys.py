"""Executions of points on a line."""

import contextlib

from line import FACTS, Guess, Line, Planner

from faultpath.faults import resolve
from faultpath.interface import Interface
from faultpath.loop import Batch, Graph, Loop, Taps, graph
from faultpath.loop import interface_of as derived
from faultpath.run.check.reads import Enough

DT_S = 0.1
SCENES = ("a", "b")


def interface_of(parts, place=""):
    return derived(FACTS % place, parts)


def execute(modules, faults=(), place="", trace=None, guard=False, plant=None):
    """Return the instants and the taps of one execution."""
    interface, parts = wired(modules, place, plant)
    asked = {"scenes": SCENES, "dt_s": DT_S, "privileged": ("field",), "guard": guard}
    taps = Taps(interface, resolve(faults, interface), **asked, observer=trace)
    with contextlib.suppress(Enough):
        return list(Loop(interface, parts).execute(Batch(SCENES, 0, DT_S), taps)), taps
    return [], taps


def wired(modules, place="", plant=None) -> tuple[Interface, Graph]:
    plant = plant or Line()
    interface = interface_of((*modules, plant), place)
    return interface, graph(interface, plant, modules)


__all__ = ["FACTS", "SCENES", "Guess", "Line", "Planner", "execute", "interface_of", "wired"]
