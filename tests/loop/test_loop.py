"""One loop: order, the past, time, queries, and what ran."""

import contextlib
from dataclasses import replace

import numpy as np
import pytest
from line import FACTS, Guess, Line, Planner

from faultpath.core.errors import SystemMistake
from faultpath.faults import parse_fault, resolve
from faultpath.interface import Interface, transitive_readers
from faultpath.loop import (
    Batch,
    Graph,
    IllegalRead,
    Loop,
    MalformedReading,
    Port,
    Taps,
    UndeclaredReader,
    graph,
    readers,
)
from faultpath.loop import interface_of as derived
from faultpath.run.check.reads import Enough, ReadLog

SCENES = ("a", "b")
RUN = {"scenes": SCENES, "dt_s": 0.1}
BATCH = Batch(SCENES, 0, 0.1)


def interface_of(parts, place=""):
    return derived(FACTS % place, parts)


def execute(modules, faults=(), place="", trace=None, guard=False, plant=None):
    """Return the instants and the taps of one execution."""
    interface, parts = wired(modules, place, plant)
    options = {"privileged": ("field",), "guard": guard, "observer": trace}
    taps = Taps(interface, resolve(faults, interface), **RUN, **options)
    with contextlib.suppress(Enough):
        return list(Loop(interface, parts).execute(BATCH, taps)), taps
    return [], taps


def wired(modules, place="", plant=None) -> tuple[Interface, Graph]:
    plant = plant or Line()
    interface = interface_of((*modules, plant), place)
    return interface, graph(interface, plant, modules)


def fault(text):
    return parse_fault(text, interface_of((Guess(), Planner(), Line())), {}, 0.1)


def test_modules_run_in_the_order_of_what_they_read() -> None:
    _, parts = wired((Planner(), Guess()))
    assert [module.name for module in parts.modules] == ["observer", "planner"]


def test_the_plant_moves_by_what_came_through_the_tap() -> None:
    instants, _ = execute((Guess(), Planner()), fault("action:scale=2"))
    moved = np.diff([instant.state.x for instant in instants], axis=0)
    assert moved[:, 0].tolist() == [0.0, 2.0, 4.0, 6.0, 8.0, 10.0, 12.0, 14.0]
    assert len(instants) == Line.steps + 1
    assert not instants[-1].inputs


class Overwriting(Planner):
    """Writes each order over the one before."""

    def begin(self, batch):
        return np.empty(len(batch.scenes))

    def step(self, inputs, memory):
        outputs, _ = super().step(inputs, None)
        memory[:] = outputs["order"]
        return {"order": memory}, memory


class OverwritingLine(Line):
    """Writes each place over the one before."""

    def advance(self, state, inputs):
        later = super().advance(state, inputs)
        state.x[:] = later.x
        return replace(later, x=state.x)


class LateLine(Line):
    """Moves by the order of the step before, which it reads after the present one is written."""

    reads, reads_past = frozenset(), frozenset({Port("action", "motor")})


@pytest.mark.parametrize("planner", [Planner, Overwriting])
def test_a_port_of_the_past_gets_the_step_before_and_first_what_was_before(planner) -> None:
    observer = Guess()
    execute((observer, planner()), plant=LateLine())
    assert [now[0] for now in observer.executed] == [-1, 0, 1, 2, 3, 4, 5, 6]
    assert [now[0] for now in observer.seen] == [1, 0, 0, 1, 3, 6, 10, 15]


@pytest.mark.parametrize(
    ("place", "seen"),
    [
        (", latency_s: 0.15", [1, 1, 1, 1, 2, 4, 7, 11]),
        (", rate_hz: 5", [1, 1, 2, 2, 7, 7, 16, 16]),
        (", rate_hz: 5, latency_s: 0.1", [1, 1, 1, 2, 2, 7, 7, 16]),
        (", rate_hz: 4", [1, 1, 1, 4, 4, 11, 11, 11]),
    ],
)
@pytest.mark.parametrize("plant", [Line, OverwritingLine])
def test_rate_and_latency_of_a_source_are_executed(place, seen, plant) -> None:
    observer = Guess()
    execute((observer, Planner()), place=place, plant=plant())
    assert [each[0] for each in observer.seen] == seen


def test_every_answer_of_a_query_passes_the_tap() -> None:
    planner = Planner(asks=3)
    _, taps = execute((Guess(), planner), fault("clearance:offset=10"))
    tap = taps.delivery_log().at("clearance", "planner.cost")
    assert (tap.deliveries, tap.answers) == (8, 24)
    assert tap.steps_faulted.tolist() == tap.steps_altered.tolist() == [8, 8]
    assert all(answer[0, 0] == 9.0 for answer in planner.answers[0])


def test_asks_of_a_step_draw_apart_and_the_first_as_a_signal_does() -> None:
    once, thrice, again = Planner(), Planner(asks=3), Planner(asks=3)
    for planner in (once, thrice, again):
        execute((Guess(), planner), fault("clearance:noise=1"))
    for step in range(Line.steps):
        np.testing.assert_array_equal(once.answers[step][0], thrice.answers[step][0])
        np.testing.assert_array_equal(again.answers[step], thrice.answers[step])
        assert len({float(answer[0, 0]) for answer in thrice.answers[step]}) == 3


def test_the_nth_ask_is_delayed_to_the_nth_ask_of_before() -> None:
    class Probing(Planner):
        def step(self, inputs, memory):
            ask = inputs["clearance", "cost"]
            self.answers.append([float(ask(np.full((2, 2), 100.0 * n))[0, 0]) for n in (1, 2)])
            return {"order": np.ones(2)}, memory

    planner = Probing()
    execute((Guess(), planner), fault("clearance:delay=2"))
    assert planner.answers[:4] == [[99, 199], [99, 199], [99, 199], [98, 198]]


def odd(kind, **changed):
    """Return a module or a plant of this kind in which some attributes are others."""
    return type("Odd", (kind,), changed)()


def execute_with(wrong):
    parts = {"observer": Guess(), "planner": Planner(), "line": Line()} | {wrong.name: wrong}
    plant = parts.pop("line")
    execute(tuple(parts.values()), plant=plant)


def without(lost):
    def sense(self, state):
        return {name: value for name, value in Line.sense(self, state).items() if name != lost}

    return odd(Line, sense=sense)


SEEN, NOW = Port("position", "seen"), Port("action", "now")
SILENT = odd(Planner, before=lambda self, batch: {})
LATE = odd(Guess, reads=frozenset(), reads_past={SEEN})
RING = odd(Guess, reads={SEEN, NOW}, reads_past=frozenset())
MUTE = odd(Guess, step=lambda self, inputs, memory: ({}, memory))
NOSY = odd(Guess, step=lambda self, inputs, memory: inputs["clearance", "cost"])
PEEKING = odd(Guess, step=lambda self, inputs, memory: inputs.truth("true_place"))


@pytest.mark.parametrize(
    ("wrong", "sentence"),
    [
        (SILENT, "'observer' reads what channel 'action' held one step before, but no value"),
        (LATE, "source 'place' is the plant's: .* read 'place' at this step and keep its earlier"),
        (RING, "observer -> planner; .*reads_past"),
        (MUTE, "'observer' writes source 'guess', but at step 0"),
        (NOSY, "'observer' looked for channel 'clearance' at 'cost'"),
        (PEEKING, "add it to its truths"),
        (odd(Guess, truths=("mass",)), "'mass', which the plant does not show"),
        (
            without("true_place"),
            "the plant shows the truth 'true_place', but at step 0 it returned",
        ),
        (without("place"), "the plant senses source 'place', but at step 0 it returned no such"),
    ],
)
def test_what_is_not_as_declared_is_named(wrong, sentence) -> None:
    with pytest.raises(SystemMistake, match=sentence):
        execute_with(wrong)


def test_a_port_too_many_of_the_plant_and_a_query_of_a_step_gone_by_are_refused() -> None:
    def late(self, inputs, memory):
        if memory is not None:
            memory(np.zeros((2, 2)))
        return {"order": np.ones(2)}, inputs["clearance", "cost"]

    with pytest.raises(UndeclaredReader, match="the plant looked for channel 'action' at 'wheel'"):
        execute_with(odd(Line, advance=lambda self, state, inputs: inputs["action", "wheel"]))
    with pytest.raises(MalformedReading, match="the query of step 0 was asked in step 1"):
        execute_with(odd(Planner, step=late))


def test_a_source_has_one_writer_and_each_port_one() -> None:
    with pytest.raises(SystemMistake, match="source 'guess' is written by 'observer' and by"):
        wired((Guess(), Guess(), Planner()))
    interface = interface_of((Guess(), Planner(), Line()))
    with pytest.raises(SystemMistake, match=r"source 'guess', which neither the plant nor"):
        graph(interface, Line(), (Planner(),))


def test_a_truth_that_is_declared_is_read() -> None:
    honest = odd(
        Guess,
        truths=("true_place",),
        step=lambda self, inputs, memory: ({"guess": inputs.truth("true_place")}, memory),
    )
    instants, _ = execute((honest, Planner()))
    assert len(instants) == Line.steps + 1


def test_a_privileged_source_is_not_read_unasked() -> None:
    interface, parts = wired((Guess(), Planner()))
    with pytest.raises(IllegalRead, match="privileged"):
        list(Loop(interface, parts).execute(BATCH, Taps(interface, **RUN)))


def test_a_trace_says_who_read_what_of_which_step() -> None:
    log = ReadLog(SCENES, steps=2)
    execute((Guess(), Planner()), trace=log, place=", latency_s: 0.1")
    reads = {(read.step, *read.tap): read for read in log.reads()}
    assert len(reads) == 2 * 5
    assert reads[1, "position", "observer.seen"].valid_step == 0
    assert reads[1, "position", "observer.seen"].source == "place"
    assert reads[1, "action", "line.motor"].valid_step == 1
    assert reads[1, "clearance", "planner.cost"].requests == 1


def test_the_interface_follows_from_the_ports() -> None:
    parts = (Guess(), Planner(), Line())
    interface = interface_of(parts)
    assert interface.channel("action").readers == ("observer.executed", "line.motor")
    assert interface.reconstructs == {"observer": ("guess",)}
    every = {name for channel in interface.channels for name in channel.readers}
    assert every == set(readers(parts))
    other = Guess()
    other.reads = frozenset({Port("position", "other")})
    with pytest.raises(SystemMistake, match=r"does not list observer\.other"):
        graph(interface, Line(), (other, Planner()))


def test_a_fault_reaches_the_readers_of_all_that_a_module_writes() -> None:
    class Filter(Guess):
        writes = ("guess", "speed")

        def step(self, inputs, memory):
            seen = inputs["position", "seen"]
            return {"guess": seen, "speed": 3.0 * seen}, memory

    class Pilot(Planner):
        reads = frozenset({Port("guessed", "start"), Port("velocity", "feedback")})

        def step(self, inputs, memory):
            self.answers.append(inputs["velocity", "feedback"].tolist())
            return {"order": np.zeros(2)}, memory

    facts = FACTS % "}\n- {name: speed, unit: m, provenance: reconstructed"
    facts = facts.replace("clearance, sources: [field]", "velocity, sources: [speed]")
    observer, pilot = Filter(), Pilot()
    interface = derived(facts, (observer, pilot, Line()))
    assert interface.reconstructs == {"observer": ("speed", "guess")}
    reached = ("observer.seen", "planner.start", "planner.feedback")
    assert transitive_readers(interface, "position") == reached
    taps = Taps(interface, resolve(fault("position:scale=2"), interface), **RUN)
    parts = graph(interface, Line(), (observer, pilot))
    list(Loop(interface, parts).execute(BATCH, taps))
    assert pilot.answers == [[6.0, 12.0]] * Line.steps


def test_a_loop_is_executed_as_often_as_wanted_and_ends_where_nothing_runs():
    class Short(Line):
        def over(self, state, step):
            return step == 3

    interface, parts = wired((Guess(), Planner()), plant=Short())
    loop = Loop(interface, parts)

    def execution():
        return loop.execute(BATCH, Taps(interface, **RUN, privileged=("field",)))

    together = [(one.step, two.step) for one, two in zip(execution(), execution(), strict=True)]
    assert together == [(0, 0), (1, 1), (2, 2), (3, 3)]
