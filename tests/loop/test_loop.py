"""One loop: order, the past, time, queries, and what ran."""

import re

import numpy as np
import pytest
from loop_toys import DT_S, FACTS, SCENES, Guess, Line, Planner, execute, interface_of, wired

from faultpath.core.errors import SystemMistake
from faultpath.faults import Fault, Scale, parse_fault, resolve
from faultpath.interface import transitive_consumers
from faultpath.loop import (
    Batch,
    IllegalRead,
    Loop,
    MalformedReading,
    Module,
    Port,
    Taps,
    UndeclaredReader,
    consumers,
    graph,
)
from faultpath.loop import interface_of as derived
from faultpath.systems.checks.recording import Recording


def fault(text):
    return parse_fault(text, interface_of((Guess(), Planner(), Line())), {}, 0.1)


def test_modules_run_in_the_order_of_what_they_read() -> None:
    modules = (Planner(), Guess())
    _, parts = wired(modules)
    assert [module.name for module in parts.modules] == ["observer", "planner"]


def test_the_plant_moves_by_what_came_through_the_tap() -> None:
    instants, _ = execute((Guess(), Planner()), [fault("action:scale=2")])
    moved = np.diff([instant.state.x for instant in instants], axis=0)
    assert moved[:, 0].tolist() == [0.0, 2.0, 4.0, 6.0, 8.0, 10.0, 12.0, 14.0]
    assert len(instants) == Line.steps + 1
    assert not instants[-1].inputs


def test_a_port_of_the_past_gets_the_step_before_and_first_what_was_before() -> None:
    observer = Guess()
    execute((observer, Planner()))
    assert [each[0] for each in observer.executed] == [-1.0, 0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0]


def test_a_past_that_nobody_gives_is_named() -> None:
    class Silent(Planner):
        def before(self, batch):
            return {}

    sentence = (
        "module 'observer' reads what channel 'action' held one step before, but nobody says what "
        "source 'order' held before the first step: write `@writes(\"order\", before=0.0)`, or "
        "return it from before() of its module"
    )
    with pytest.raises(SystemMistake, match=re.escape(sentence)):
        execute((Guess(), Silent()))


def test_a_source_of_the_plant_has_no_past() -> None:
    class Late(Guess):
        reads, reads_past = frozenset[Port](), frozenset({Port("position", "seen")})

    sentence = "source 'place' is the plant's: .* read 'place' at this step and keep its earlier"
    with pytest.raises(SystemMistake, match=sentence):
        execute((Late(), Planner()))


@pytest.mark.parametrize(
    ("lost", "sentence"),
    [
        ("true_place", "the plant shows the truth 'true_place', but at step 0 it returned no such"),
        ("place", "the plant senses source 'place', but at step 0 it returned no such entry"),
    ],
)
def test_a_plant_that_forgets_what_it_senses_is_named(lost, sentence) -> None:
    class Mute(Line):
        def sense(self, state):
            return {name: value for name, value in super().sense(state).items() if name != lost}

    modules = (Guess(), Planner())
    interface = interface_of((*modules, Mute()))
    taps = Taps(interface, scenes=SCENES, dt_s=DT_S, privileged=("field",))
    with pytest.raises(SystemMistake, match=sentence):
        list(Loop(interface, graph(interface, Mute(), modules)).execute(_batch(), taps))


def test_a_plant_that_looks_for_a_port_too_many_is_called_the_plant() -> None:
    class Nosy(Line):
        def advance(self, state, inputs):
            return inputs["action", "wheel"]

    modules = (Guess(), Planner())
    interface = interface_of((*modules, Nosy()))
    taps = Taps(interface, scenes=SCENES, dt_s=DT_S, privileged=("field",))
    with pytest.raises(UndeclaredReader, match="the plant looked for channel 'action' at 'wheel'"):
        list(Loop(interface, graph(interface, Nosy(), modules)).execute(_batch(), taps))


@pytest.mark.parametrize(
    ("place", "seen"),
    [
        (", latency_s: 0.2", [1, 1, 1, 1, 2, 4, 7, 11]),
        (", latency_s: 0.15", [1, 1, 1, 1, 2, 4, 7, 11]),
        (", rate_hz: 5", [1, 1, 2, 2, 7, 7, 16, 16]),
        (", rate_hz: 5, latency_s: 0.1", [1, 1, 1, 2, 2, 7, 7, 16]),
        (", rate_hz: 10", [1, 1, 2, 4, 7, 11, 16, 22]),
        (", rate_hz: 4", [1, 1, 1, 4, 4, 11, 11, 11]),
    ],
)
def test_rate_and_latency_of_a_source_are_executed(place, seen) -> None:
    observer = Guess()
    execute((observer, Planner()), place=place)
    assert [each[0] for each in observer.seen] == seen


def test_every_answer_of_a_query_passes_the_tap() -> None:
    planner = Planner(asks=3)
    _, taps = execute((Guess(), planner), [fault("clearance:offset=10")])
    receipt = taps.receipts().at("clearance", "planner.cost")
    assert (receipt.deliveries, receipt.asks) == (8, 24)
    assert receipt.steps_faulted.tolist() == receipt.steps_altered.tolist() == [8, 8]
    assert all(answer[0, 0] == 9.0 for answer in planner.answers[0])


def test_asks_of_a_step_draw_apart_and_the_first_as_a_signal_does() -> None:
    once, thrice, again = Planner(), Planner(asks=3), Planner(asks=3)
    for planner in (once, thrice, again):
        execute((Guess(), planner), [fault("clearance:noise=1")])
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
    execute((Guess(), planner), [fault("clearance:delay=2")])
    assert planner.answers[:4] == [[99, 199], [99, 199], [99, 199], [98, 198]]


def test_a_query_of_a_step_gone_by_is_refused() -> None:
    class Late(Planner):
        def step(self, inputs, memory):
            if memory is not None:
                memory(np.zeros((2, 2)))
            return {"order": np.ones(2)}, inputs["clearance", "cost"]

    with pytest.raises(MalformedReading, match="the query of step 0 was asked in step 1"):
        execute((Guess(), Late()))


def test_what_is_not_declared_cannot_be_read() -> None:
    class Peeking(Guess):
        def step(self, inputs, memory):
            inputs["clearance", "cost"]

    with pytest.raises(SystemMistake, match=r"'observer' looked for channel 'clearance' at 'cost'"):
        execute((Peeking(), Planner()))


def test_truth_is_for_those_who_declare_it() -> None:
    class Peeking(Guess):
        def step(self, inputs, memory):
            return {"guess": inputs.truth("true_place")}, memory

    with pytest.raises(SystemMistake, match="add it to its truths"):
        execute((Peeking(), Planner()))
    honest = Peeking()
    honest.truths = ("true_place",)
    execute((honest, Planner()))
    honest.truths = ("mass",)
    with pytest.raises(SystemMistake, match=r"'mass', which the plant does not show"):
        wired((honest, Planner()))


def test_a_privileged_source_is_not_read_unasked() -> None:
    interface, parts = wired((Guess(), Planner()))
    with pytest.raises(IllegalRead, match="privileged"):
        list(Loop(interface, parts).execute(_batch(), Taps(interface, scenes=SCENES, dt_s=0.1)))


def test_modules_that_wait_for_each_other_are_named() -> None:
    ring = Guess()
    ring.reads, ring.reads_past = ring.reads | {Port("action", "now")}, frozenset()
    with pytest.raises(SystemMistake, match=r"observer -> planner; .*reads_past"):
        wired((ring, Planner()))


def test_a_source_has_one_writer_and_each_port_one() -> None:
    with pytest.raises(SystemMistake, match="source 'guess' is written by 'observer' and by"):
        wired((Guess(), Guess(), Planner()))
    interface = interface_of((Guess(), Planner(), Line()))
    with pytest.raises(SystemMistake, match=r"source 'guess', which neither the plant nor"):
        graph(interface, Line(), (Planner(),))


def test_a_module_that_forgets_its_source_is_named() -> None:
    class Mute(Guess):
        def step(self, inputs, memory):
            return {}, memory

    with pytest.raises(SystemMistake, match="'observer' writes source 'guess', but at step 0"):
        execute((Mute(), Planner()))


def test_a_trace_says_who_read_what_of_which_step() -> None:
    trace = Recording(SCENES, steps=2)
    execute((Guess(), Planner()), trace=trace, place=", latency_s: 0.1")
    assert len(trace.reads) == 2 * 5
    assert trace.reads[1, "position", "observer.seen"].valid_step == 0
    assert trace.reads[1, "position", "observer.seen"].source == "place"
    assert trace.reads[1, "action", "line.motor"].valid_step == 1
    assert trace.reads[1, "clearance", "planner.cost"].asks == 1


def test_the_interface_follows_from_the_ports() -> None:
    parts = (Guess(), Planner(), Line())
    interface = interface_of(parts)
    assert interface.channel("action").consumers == ("observer.executed", "line.motor")
    assert interface.reconstructs == {"observer": ("guess",)}
    every = {name for channel in interface.channels for name in channel.consumers}
    assert every == set(consumers(parts))
    other = Guess()
    other.reads = frozenset({Port("position", "other")})
    with pytest.raises(SystemMistake, match=r"does not list observer\.other"):
        graph(interface, Line(), (other, Planner()))


def test_a_filter_reconstructs_position_and_velocity():
    class Filter(Module):
        """Holds where the vehicle was, and differences that."""

        name, writes = "filter", ("guess", "speed")
        reads = frozenset({Port("position", "seen")})

        def begin(self, batch):
            return np.full(len(batch.scenes), np.nan)

        def step(self, inputs, memory):
            seen = inputs["position", "seen"]
            gone = np.where(np.isnan(memory), 0.0, seen - memory)
            return {"guess": seen, "speed": gone / DT_S}, seen.copy()

    class Pilot(Module):
        """Orders what the filter says of the speed, and one more."""

        name, writes = "pilot", ("order",)
        reads = frozenset({Port("guessed", "start"), Port("velocity", "feedback")})

        def __init__(self):
            self.speeds = []

        def step(self, inputs, memory):
            self.speeds.append(inputs["velocity", "feedback"].tolist())
            return {"order": np.ones_like(inputs["guessed", "start"])}, memory

    facts = FACTS % ""
    facts = facts.replace(
        "- {name: field,", "- {name: speed, unit: m/s, provenance: reconstructed}\n- {name: field,"
    ).replace("- {name: clearance, sources: [field]}", "- {name: velocity, sources: [speed]}")
    pilot = Pilot()
    parts = (Filter(), pilot, Line())
    interface = derived(facts, parts)
    assert interface.reconstructs == {"filter": ("guess", "speed")}
    reached = ("filter.seen", "pilot.start", "pilot.feedback")
    assert transitive_consumers(interface, "position") == reached
    scaled = Fault(channel="position", intervention=Scale(factor=2.0))
    taps = Taps(interface, resolve([scaled], interface), scenes=SCENES, dt_s=DT_S)
    list(Loop(interface, graph(interface, Line(), parts[:2])).execute(_batch(), taps))
    assert pilot.speeds[0] == [0.0, 0.0]
    assert np.allclose(pilot.speeds[1:], 2.0 / DT_S)  # a metre a step, seen as two


def test_a_loop_is_executed_as_often_as_wanted_and_ends_where_nothing_runs():
    class Short(Line):
        def over(self, state, step):
            return step == 3

    modules = (Guess(), Planner())
    interface = interface_of((*modules, Short()))
    loop = Loop(interface, graph(interface, Short(), modules))

    def execution():
        taps = Taps(interface, scenes=SCENES, dt_s=0.1, privileged=("field",))
        return loop.execute(_batch(), taps)

    together = [(one.step, two.step) for one, two in zip(execution(), execution(), strict=True)]
    assert together == [(0, 0), (1, 1), (2, 2), (3, 3)]


def _batch() -> Batch:
    return Batch(SCENES, 0, 0.1)
