"""Taps on what is called: an argument is delivered wherever other people's code passes it."""

from dataclasses import dataclass
from functools import partial
from types import SimpleNamespace

import numpy as np
import pytest
from plain import composed, stepped

from faultpath.core.errors import SystemMistake
from faultpath.faults import parse_fault
from faultpath.loop import Inputs, NotDelivered, Port, check_reached
from faultpath.run.attempt import Done, attempt
from faultpath.run.plan import Treatment
from faultpath.system import tapped, writes


class Filter:
    """An estimator as somebody wrote it."""

    def __init__(self, share=0.5):
        self.share, self.last = share, 0.0

    def update(self, time, speed, *, scale=1.0):
        self.last += self.share * (scale * speed - self.last)
        return self.last


class Cruise:
    """A controller as somebody wrote it, that calls the estimator itself."""

    def __init__(self):
        self.filter, self.limit = Filter(), 2.0

    def limited(self, speed):
        return min(self.limit, speed)

    def command(self, time):
        return self.filter.update(time, 7.0) + self.limited(speed=9.0)


def product(time, speed, *, scale=1.0):
    return time * speed * scale


@dataclass
class Product:
    time: float
    speed: float
    scale: float = 1.0


@pytest.mark.parametrize(
    ("what", "value"),
    [
        (product, lambda result: result),
        (partial(product, scale=1.0), lambda result: result),
        (Filter(1.0).update, lambda result: 2 * result),
        (Product, lambda result: result.time * result.speed),
    ],
)
@pytest.mark.parametrize(
    "call",
    [
        lambda f: f(2.0),
        lambda f: f(2.0, 9.0),
        lambda f: f(2.0, speed=9.0),
        lambda f: f(speed=9.0, time=2.0),
    ],
)
def test_what_is_delivered_takes_the_place_of_what_the_caller_passes(what, value, call) -> None:
    def run(stand_in):
        return value(call(stand_in))

    assert stepped(lambda: tapped(what, "speed", at="part"), run, speed=5.0) == [10.0]


def test_an_argument_may_have_the_channel_of_another_name_and_take_any_name() -> None:
    renamed = writes("out", of=lambda: tapped(product, speed="wheels", at="part"))(lambda f: 0.0)
    assert renamed.ports == {Port("wheels", "part.speed")}
    taken = stepped(
        lambda: tapped(lambda **named: named["gain"], "gain", at="part"), lambda f: f(), gain=3.0
    )
    assert taken == [3.0]


def test_the_object_itself_is_as_it_was() -> None:
    own = Filter(1.0)
    before = dict(vars(own))
    stand_ins = []

    def make():
        stand_ins.append(tapped(own.update, "speed", at="part"))
        return stand_ins[-1]

    assert stepped(make, lambda update: update(0.0, 1.0) + own.update(0.0, 3.0), speed=5.0) == [8.0]
    assert vars(own).keys() == before.keys()
    assert own.update.__func__ is Filter.update
    with pytest.raises(SystemMistake, match="outside of a step"):
        stand_ins[-1](0.0)


MISTAKES = {
    "tapped Filter.update: unknown argument 'sped'; did you mean 'speed'": lambda: tapped(
        Filter().update, "sped", at="part"
    ),
    r"'update' is a method: .* x\.update = tapped\(x\.update, 'its argument', at='part'\)": (
        lambda: tapped(Filter(), "update", at="part")
    ),
    "'part' read 'speed' of product while it was made": lambda: writes(
        "out", of=lambda: tapped(product, "speed", at="part")(1.0)
    )(lambda made: 0.0),
    "'part' calls max, which is compiled, with speed by name, and it refuses": lambda: stepped(
        lambda: tapped(max, "speed", at="part"), lambda largest: largest(1.0, 2.0), speed=5.0
    ),
    "taps objects that are made of readings: let the function that makes": lambda: writes(
        "out", of=lambda share: tapped(Filter(share).update, "speed", at="part")
    )(lambda update: 0.0).step(
        Inputs("module", 0, {Port("share", "share"): np.ones(1)}, {}), [None]
    ),
}


def test_a_stand_in_that_calls_the_method_of_the_object_itself_is_refused() -> None:
    def make():
        own = Filter()
        stand_in = tapped(own, "share", at="part")
        stand_in.update = tapped(own.update, "speed", at="part")
        return stand_in

    with pytest.raises(
        SystemMistake, match=r"past its taps: Filter\.update\..* is the Filter that"
    ):
        writes("out", of=make)(lambda made: made.update(0.0))


@pytest.mark.parametrize("sentence", MISTAKES)
def test_a_mistake_is_one_sentence(sentence) -> None:
    with pytest.raises(SystemMistake, match=sentence):
        MISTAKES[sentence]()


def cruise(limits=True):
    """Return a module of their controller, of which the filter or both parts read the speed."""

    def make():
        parts = Cruise()
        parts.filter.update = tapped(parts.filter.update, "speed", at="filter")
        parts.limited = tapped(parts.limited, "speed", at="limits")
        return SimpleNamespace(parts=parts, limits=limits)

    def push(made, time):
        return made.parts.command(time) if made.limits else made.parts.filter.update(time)

    return writes("push", of=make)(push)


def attempted(limits, fault):
    cruising = composed(
        {"only": [cruise(limits)]},
        {"time": "s", "speed": "m/s", "push": "m/s"},
        lambda rng: {"time": 0.0, "speed": rng.normal()},
        lambda state, push, rng: {"time": state["time"] + 0.1, "speed": state["speed"] - push},
    )
    faults = parse_fault(fault, cruising.interface, {}, 0.1)
    return attempt(cruising, Treatment(variant="only", faults=faults), ("seed/1",))


@pytest.mark.parametrize("part", ["filter", "limits"])
def test_a_fault_of_one_call_between_their_parts_reaches_that_call_alone(part) -> None:
    taps = attempted(True, f"speed:scale=3@{part}").taps
    acted = {tap.reader: tap.faulted_steps for tap in taps if tap.channel == "speed"}
    assert acted == {"filter.speed": 0, "limits.speed": 0} | {f"{part}.speed": 2}


def test_a_fault_stops_where_the_method_is_never_called() -> None:
    reply = attempted(False, "speed:scale=3")
    assert isinstance(reply, Done)
    with pytest.raises(NotDelivered, match=r"speed -> limits\.speed"):
        check_reached(reply.taps, [9])
