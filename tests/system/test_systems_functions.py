"""Plain functions as a plant: a scene is what `start` draws, a step is what `step` does."""

import numpy as np
import pytest
from gym_toys import SCENES, Steer, trials
from libraries import LIBRARIES
from plain import functions

from faultpath.core.errors import SystemMistake
from faultpath.faults import parse_fault
from faultpath.interface import transitive_readers
from faultpath.run.attempt import attempt
from faultpath.run.plan import Treatment
from faultpath.system import ComposedSystem, Status, writes
from faultpath.system.observed import hashed

UNITS = {"place": "m", "push": "m", "clock": "1"}


def start(rng):
    return {"at": rng.uniform(-1, 1), "clock": 0}


def step(state, push, rng):
    at = state["at"] + float(push) + rng.normal(scale=0.05)
    return {"at": at, "clock": state["clock"] + 1}


def cart(start=start, step=step, **options):
    observes = {"place": "at", "clock": "clock"}
    plant = functions(start, step, steps=6, dt_s=0.5, observes=observes, **options)
    return ComposedSystem("cart", plant, {"only": [Steer()]}, UNITS)


def beyond(state):
    return abs(state["at"]) > 1.5


def test_a_scene_ends_where_over_says_so_and_is_frozen():
    episodes = []

    def note(episode):
        episodes.append(episode)
        return not episode.terminated

    built = cart(over=beyond, succeeded=note)
    episodes.clear()
    outcomes = trials(built)
    assert {o.status for o in outcomes} == {Status.SUCCESS, Status.CRASH}
    assert sorted(len(e.rewards) * 0.5 for e in episodes) == sorted(o.time_s for o in outcomes)
    assert all(list(e["clock"]) == list(range(len(e.rewards) + 1)) for e in episodes)
    for episode in episodes:
        fell = np.abs(episode["place"]) > 1.5
        assert not fell[:-1].any()
        assert fell[-1] == episode.terminated


def test_noise_belongs_to_scene_seed_and_step_and_not_to_who_runs_beside():
    built = cart(over=beyond)
    by_scene = {o.scene: o for o in trials(built)}
    mixed = [SCENES[i] for i in (3, 1)]
    assert trials(built, mixed) == [by_scene[scene] for scene in mixed]
    other = trials(built, mixed, seed=1)
    assert [o.initial_hash for o in other] == [by_scene[s].initial_hash for s in mixed]
    assert all(o.disturbance_hash != by_scene[o.scene].disturbance_hash for o in other)


def test_a_module_stands_in_for_a_source_of_several_numbers():
    plant = functions(
        lambda rng: {"pair": rng.uniform(size=2)},
        lambda state, push, rng: {"pair": state["pair"] + push},
        observes={"seen": "pair"},
    )

    @writes("guessed")
    def guess(seen):
        return 2 * seen

    @writes("push")
    def steer(place):
        return place[:, 0]

    built = ComposedSystem(
        "pair",
        plant,
        {"seeing": [steer], "guessing": [guess, steer]},
        dict.fromkeys(("seen", "guessed", "push"), "m"),
        channels={"place": ("seen", "guessed")},
    )
    assert built.interface.source("guessed").shape == (2,)
    assert built.interface.reconstructs == {"guess": ("guessed",)}
    assert built.variants["seeing"].bindings == {"place": "seen"}
    assert built.variants["guessing"].bindings == {"place": "guessed"}
    assert len(trials(built, variant="guessing")) == len(SCENES)


def test_modules_read_each_other_write_the_same_source_or_read_nothing():
    """Each of them was refused, or left out of what the interface says."""

    @writes("guess", past="wish")
    def guess(place, wish):
        return place + wish

    @writes("guess", name="other")
    def twice(place):
        return 2.0 * place

    @writes("wish", before=0.0)
    def wish(guess):
        return -guess

    @writes("goal")
    def goal():
        return 1.0

    @writes("push")
    def push(wish, goal):
        return wish + goal

    plant = functions(start, step, observes={"place": "at"})
    units = dict.fromkeys(("place", "guess", "wish", "goal", "push"), "m")
    variants = {"one": [guess, wish, goal, push], "two": [twice, wish, goal, push]}
    built = ComposedSystem("cart", plant, variants, units)
    assert built.interface.reconstructs == {
        "guess": ("guess",),
        "other": ("guess",),
        "wish": ("wish",),
    }
    assert built.interface.source("goal").provenance == "commanded"
    reached = transitive_readers(built.interface, "place")
    assert set(reached) == {"guess.place", "other.place", "wish.guess", "guess.wish", "push.wish"}
    assert not any(outcome.failed for outcome in trials(built, variant="one"))


def test_the_hash_of_a_state_that_holds_an_object_does_not_depend_on_places() -> None:
    def instance(name: str, module: str) -> object:
        return type(name, (), {"__module__": module})()

    one, two = instance("Craft", "faultpath_system_a1"), instance("Craft", "faultpath_system_b2")
    assert hashed({"craft": one, "x": 1.0}) == hashed({"craft": two, "x": 1.0})
    assert hashed({"craft": one}) != hashed({"craft": instance("Boat", "faultpath_system_a1")})


@LIBRARIES
def test_the_hash_of_a_state_is_of_all_its_bits(to) -> None:
    one, two = to(np.array([1.0, 2.0])), to(np.array([1.0, 2.0 + 1e-12]))
    assert hashed({"at": one}) == hashed({"at": to(np.array([1.0, 2.0]))}) != hashed({"at": two})


def test_a_real_number_that_becomes_whole_stays_real_alone_as_beside_others():
    def stopped(state, push, rng):
        return state | {"at": max(0, state["at"] - 1.0), "clock": state["clock"] + 1}

    built = cart(step=stopped)
    shifted = parse_fault("place:offset=0.3", built.interface, {}, 0.1)
    done = attempt(built, Treatment(variant="only", faults=shifted), SCENES[:1])
    assert done.outcomes[0].altered_steps == 6


def test_a_key_that_the_state_has_not_is_told_with_those_that_it_has():
    sentence = "observes: source 'place': the state has no key 'plce'; it has at, clock"
    with pytest.raises(SystemMistake, match=sentence):
        functions(start, step, observes={"place": "plce"})


def test_a_state_may_hold_what_has_another_shape_in_each_scene():
    def drawn(rng):
        return start(rng) | {"obstacles": np.zeros(int(rng.integers(1, 50)))}

    def moved(state, push, rng):
        return step(state, push, rng) | {"obstacles": state["obstacles"]}

    built = cart(drawn, moved)
    worlds = map(built.plant().world, SCENES, [0] * 6)
    assert len({len(world.observation["obstacles"]) for world in worlds}) > 1
    assert [outcome.failed for outcome in trials(built)] == [False] * len(SCENES)
