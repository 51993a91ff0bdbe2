"""Taps on objects that nobody here wrote: a fault reaches who reads, when it reads."""

import copy
from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np
import pytest
from plain import composed, stepped

from faultpath import audit
from faultpath.core.errors import SystemMistake
from faultpath.faults import parse_fault
from faultpath.loop import Batch, Inputs, NotDelivered, Port, check_reached
from faultpath.run.attempt import attempt
from faultpath.run.plan import Treatment
from faultpath.system import shared_objects, tapped, writes


@dataclass
class Parameters:
    """What the parts of a drive share, as they wrote it."""

    flux: float = 0.5
    resistance: float = 2.0

    def linked(self, current):
        return self.flux + 0.1 * current


class Observer:
    def __init__(self, par, gain):
        self.par, self.gain = par, gain

    def estimate(self, current):
        self.par.flux = self.par.flux + self.gain
        return self.par.flux


class Controller:
    def __init__(self, par):
        self.par, self.bias = par, 0.25

    def command(self, current):
        return self.par.linked(current) * self.bias


def delivered(**values):
    return {Port(name, place): np.array(value) for name, (place, value) in values.items()}


def test_what_is_read_is_delivered_and_all_else_stays_shared():
    par = Parameters()

    def make():
        return Controller(tapped(par, "flux", at="control"))

    module = writes("voltage", of=make)(lambda control, current: control.command(current))
    assert module.reads == {Port("flux", "control.flux"), Port("current", "current")}
    assert module.reader(Port("flux", "control.flux")) == "control.flux"
    readings = delivered(current=("current", [0.0, 1.0]), flux=("control.flux", [1.0, 2.0]))
    memory = module.begin(Batch(("a", "b"), 0, 0.1))
    outputs, memory = module.step(Inputs("module", 0, readings, {}), memory)
    assert outputs["voltage"].tolist() == [0.25 * 1.0, 0.25 * 2.1]
    stand_in = memory[0].objects.par
    assert isinstance(stand_in, Parameters)
    par.resistance = 3.0
    assert stand_in.resistance == 3.0
    assert par.flux == 0.5
    small = writes("out", of=lambda: tapped({"c_Dx": 1.0}, c_Dx="drag", at="filter"))
    assert small(lambda par: par["c_Dx"]).reads == {Port("drag", "filter.c_dx")}


def test_an_ended_scene_is_not_asked_any_more():
    currents = []

    def count(_, current):
        currents.append(float(current))
        return current

    module = writes("seen", of=SimpleNamespace)(count)
    memory = module.begin(Batch(("a", "b"), 0, 0.1))
    for step, running in enumerate(([True, True], [False, True])):
        readings = delivered(current=("current", [1.0 + step, 5.0 + step]))
        inputs = Inputs("module", step, readings, {}, np.array(running))
        outputs, memory = module.step(inputs, memory)
    assert currents == [1.0, 5.0, 6.0]
    assert outputs["seen"].tolist() == [1.0, 6.0]


def test_a_number_is_real_whether_or_not_python_makes_it_whole():
    module = writes("push", of=SimpleNamespace)(lambda _, speed: max(0, speed))
    outputs, _ = module.step(
        Inputs("module", 0, delivered(speed=("speed", [-1.0])), {}),
        module.begin(Batch(("a",), 0, 0.1)),
    )
    assert (outputs["push"].tolist(), outputs["push"].dtype) == ([0.0], np.float64)


def test_a_mapping_is_delivered_however_it_is_read():
    seen = {}

    def read(par):
        seen.update(item=par["mass"], get=par.get("mass"), missing=par.get("span", 7))
        seen.update(copied=dict(par), spread={**par}, values=list(par.values()))
        seen.update(default=par.setdefault("mass", 9.0), popped=par.copy().pop("mass"))
        return par["mass"]

    stepped(lambda: tapped({"mass": 1.0, "treatment": 0.2}, "mass", at="part"), read, mass=4.0)
    both = {"mass": 4.0, "treatment": 0.2}
    assert (seen.pop("copied"), seen.pop("spread")) == (both, both)
    assert (seen.pop("default"), seen.pop("popped")) == (4.0, 4.0)
    assert seen == {"item": 4.0, "get": 4.0, "missing": 7, "values": [4.0, 0.2]}


def _pops(par):
    assert par.pop("mass") == 4.0
    return par.get("mass", 7.0)


@pytest.mark.parametrize(
    ("write", "value"),
    [
        (lambda par: par.update(mass=5.0) or par["mass"], 5.0),
        (lambda par: par.__ior__({"mass": 6.0})["mass"], 6.0),
        (_pops, 7.0),
    ],
)
def test_what_a_reader_writes_into_a_mapping_is_its_own_however_it_writes(write, value):
    assert stepped(lambda: tapped({"mass": 1.0}, "mass", at="part"), write, mass=4.0) == [value]


def test_mistakes_are_told_in_a_sentence():
    with pytest.raises(SystemMistake, match="unknown attribute 'flax'; did you mean 'flux'"):
        tapped(Parameters(), "flax", at="control")
    with pytest.raises(SystemMistake, match="unknown key 'mess'"):
        tapped({"mass": 1.0}, "mess", at="control")
    with pytest.raises(SystemMistake, match="slots, a tuple or compiled code"):
        tapped(1.0 + 2.0j, "real", at="control")

    class Copies:
        def __init__(self, par):
            self.mass = par["mass"]

    with pytest.raises(SystemMistake, match="read 'mass' of dict while it was made"):
        writes("out", of=lambda: Copies(tapped({"mass": 1.0}, "mass", at="a")))(lambda made: 0.0)

    class Solves:
        def __init__(self):
            self.mass, self.solver = 1.0, SimpleNamespace(f=self.f)

        def f(self):
            return self.mass

    def bound(rebind):
        solving = Solves()
        stand_in = tapped(solving, "mass", at="filter")
        solving.solver.f = stand_in.f if rebind else solving.f
        return stand_in

    with pytest.raises(SystemMistake, match=r"past its taps: Solves\.solver\.f\.__self__ is the"):
        writes("out", of=lambda: bound(False))(lambda made: made.solver.f())
    assert writes("out", of=lambda: bound(True))(lambda made: made.solver.f()).ports
    with pytest.raises(SystemMistake, match="objects and a memory"):
        writes("out", of=Parameters)(lambda made, memory: (0.0, memory))


def drive(gain, late=False):
    """Two parts that read one parameter object; the observer writes into it if it has a gain."""

    def make():
        par = Parameters()
        observer = Observer(tapped(copy.copy(par), "flux", at="observer"), gain)
        control = Controller(tapped(par, "flux", at="control"))
        return SimpleNamespace(observer=observer, control=control, t=0)

    def regulate(made, current):
        made.t += 1
        if late and made.t < 5:
            return 0.0
        return made.control.command(current) + made.observer.estimate(current)

    return writes("voltage", of=make)(regulate)


def system(**variants):
    return composed(
        {name: [module] for name, module in variants.items()},
        {"current": "A", "flux": "Vs", "voltage": "V"},
        lambda rng: {"current": rng.normal(), "flux": 0.5},
        lambda state, action, rng: state | {"current": 0.5 * state["current"] - 0.1 * action},
        action="voltage",
        steps=10,
    )


@pytest.mark.usefixtures("without_pages")
def test_parts_inside_one_module_are_readers_of_their_own():
    drives = system(fixed=drive(0.0), slow=drive(0.0, late=True))
    assert set(drives.interface.channel("flux").readers) == {"observer.flux", "control.flux"}
    run = audit(drives, baseline="fixed", repair="slow", fault="flux:scale=3", scenes=8)
    conditions = [condition.name for condition in run.record.conditions]
    assert conditions == ["correct", "control", "observer", "shared"]


def attempted(module, fault):
    tested = system(only=module)
    faults = parse_fault(fault, tested.interface, {}, 0.1)
    return attempt(tested, Treatment(variant="only", faults=faults), ("seed/1", "seed/2"))


def test_delivery_logs_count_what_was_read_and_a_fault_after_a_write_is_not_delivered():
    taps = {tap.reader: tap for tap in attempted(drive(0.1), "flux:scale=3").taps}
    assert taps["observer.flux"].deliveries == 2
    assert taps["control.flux"].deliveries == taps["control.flux"].faulted_steps == 2 * 10
    taps = {tap.reader: tap for tap in attempted(drive(0.0, late=True), "flux:scale=3").taps}
    assert taps["control.flux"].deliveries == taps["control.flux"].faulted_steps == 2 * 6
    late = attempted(drive(0.1), "flux:scale=3,onset=5")
    with pytest.raises(NotDelivered, match=r"flux -> observer\.flux"):
        check_reached(late.taps, [9, 9])


@pytest.mark.parametrize("fault", ["flux:delay=2", "flux:hold=3", "flux:freeze,onset=1"])
def test_a_scene_that_reads_seldom_gets_the_same_whoever_reads_beside_it(fault):
    def make():
        return SimpleNamespace(par=tapped(Parameters(), "flux", at="control"), step=-1, seen=0.0)

    @writes("voltage", of=make)
    def seldom(parts, every):
        parts.step += 1
        if parts.step % every == 0:
            parts.seen = parts.par.flux
        return parts.seen

    built = composed(
        {"only": [seldom]},
        {"flux": "Vs", "voltage": "V", "every": "1"},
        lambda rng: {"flux": 0.0, "every": int(rng.integers(2, 5))},
        lambda state, voltage, rng: state | {"flux": state["flux"] + 1.0},
        action="voltage",
        steps=10,
    )
    treatment = Treatment(variant="only", faults=parse_fault(fault, built.interface, {}, 0.1))
    scenes = tuple(f"seed/{i}" for i in range(4))
    together = attempt(built, treatment, scenes)
    alone = [attempt(built, treatment, (scene,)).outcomes[0] for scene in scenes]
    assert list(together.outcomes) == alone
    assert len({outcome.altered_steps for outcome in alone}) > 1


def test_what_parts_share_is_found_and_what_a_run_writes_is_named():
    par = Parameters()
    observer, control = Observer(par, 0.1), Controller(par)
    observer.bias = 0.25

    def closes():
        return par.resistance

    shared = shared_objects(
        {"observer": observer, "control": control, "hook": closes},
        run=lambda: observer.estimate(0.0),
    )
    assert [str(each) for each in shared] == [
        "Parameters is one object at control.par, hook.par, observer.par; "
        "the run wrote observer.par.flux",
        "bias = 0.25 at control.bias, observer.bias",
    ]
    par = Parameters()
    copied = Observer(copy.copy(par), 0.1)
    shared = shared_objects(
        {"control": Controller(par), "limits": Controller(par), "observer": copied},
        run=lambda: copied.estimate(0.0),
    )
    assert [str(each) for each in shared if "bias" not in each.what] == [
        "Parameters is one object at control.par, limits.par",
        "flux = 0.5 at control.par.flux, limits.par.flux, observer.par.flux; "
        "the run wrote observer.par.flux",
        "resistance = 2.0 at control.par.resistance, limits.par.resistance, "
        "observer.par.resistance",
    ]
    apart = shared_objects({"a": Observer(Parameters(), 0.0), "b": Controller(Parameters())})
    assert [each.what for each in apart] == ["flux = 0.5", "resistance = 2.0"]
    assert not any(each.alias for each in apart)
