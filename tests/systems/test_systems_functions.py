"""Plain functions as a plant: a scene is what `start` draws, a step is what `step` does."""

import numpy as np
import pytest
from gym_toys import SCENES, Steer, fly, functions

import faultpath
from faultpath.core.errors import SystemMistake
from faultpath.loop import Port
from faultpath.systems import ComposedSystem, FunctionPlant, writes
from faultpath.systems.observed import hashed
from faultpath.trials import Status

SYSTEM = """
from faultpath.loop import Module, Port
from faultpath.systems import ComposedSystem, FunctionPlant, Parts

class Brake(Module):
    name, writes = "brake", ("push",)

    def __init__(self, known):
        more = {Port("gain", "model")} if known else set()
        self.reads = frozenset({Port("place", "feedback"), *more})

    def step(self, inputs, memory):
        gain = inputs.get(Port("gain", "model"), 1.0)
        return {"push": -0.5 * inputs["place", "feedback"] / gain}, memory

def start(rng):
    return {"place": rng.uniform(1, 2), "gain": rng.uniform(0.5, 1.5)}

def step(state, push, rng):
    return state | {"place": state["place"] + state["gain"] * push + rng.normal(scale=0.01)}

def create() -> ComposedSystem:
    plant = FunctionPlant(start, step, observes={"place": "place", "gain": "gain"}, action="push",
        steps=12, dt_s=0.1, succeeded=lambda episode: abs(episode["place"][-1]) < 0.05)
    variants = {"known": Parts("", [Brake(True)]), "typical": Parts("", [Brake(False)])}
    units = {"place": "m", "gain": {"unit": "1", "provenance": "estimated"}, "push": "m"}
    return ComposedSystem("cart", plant, variants, units)
"""


UNITS = {"place": "m", "push": "m", "clock": "1"}


def start(rng):
    return {"at": rng.uniform(-1, 1), "clock": 0}


def step(state, push, rng):
    at = state["at"] + float(push) + rng.normal(scale=0.05)
    return {"at": at, "clock": state["clock"] + 1}


def cart(**given):
    episodes = []

    def note(episode):
        episodes.append(episode)
        return not episode.terminated

    more = {"over": lambda state: abs(state["at"]) > 1.5, "succeeded": note} | given
    observes = {"place": "at", "clock": "clock"}
    plant = functions(start, step, steps=6, dt_s=0.5, observes=observes, **more)
    built = ComposedSystem("cart", plant, {"only": [Steer()]}, UNITS)
    episodes.clear()
    return built, episodes


def test_a_scene_ends_where_over_says_so_and_is_frozen():
    built, episodes = cart()
    outcomes = fly(built)
    assert {o.status for o in outcomes} == {Status.SUCCESS, Status.CRASH}
    assert sorted(len(e.rewards) * 0.5 for e in episodes) == sorted(o.time_s for o in outcomes)
    assert all(list(e["clock"]) == list(range(len(e.rewards) + 1)) for e in episodes)
    for episode in episodes:
        beyond = np.abs(episode["place"]) > 1.5
        assert not beyond[:-1].any()
        assert beyond[-1] == episode.terminated


def test_noise_belongs_to_scene_seed_and_step_and_not_to_who_flies_beside():
    built, _ = cart()
    by_scene = {o.scene: o for o in fly(built)}
    mixed = [SCENES[i] for i in (3, 1)]
    assert fly(built, mixed) == [by_scene[scene] for scene in mixed]
    other = fly(built, mixed, seed=1)
    assert [o.initial_hash for o in other] == [by_scene[s].initial_hash for s in mixed]
    assert all(o.disturbance_hash != by_scene[o.scene].disturbance_hash for o in other)


def test_a_module_that_reads_the_past_says_what_was_before():
    late = Steer()
    late.reads_past = frozenset({Port("push", "executed")})
    with pytest.raises(SystemMistake, match="before the first step"):
        ComposedSystem("late", cart()[0].plant(), {"only": [late]}, UNITS)


def test_a_system_of_functions_is_audited(tmp_path):
    (tmp_path / "cart.py").write_text(SYSTEM)
    question = {"baseline": "typical", "repair": "known", "fault": "gain:scale=0.2", "scenes": 30}
    run = faultpath.audit(
        tmp_path / "cart.py", **question, workers=0, folder=tmp_path / "run", progress=False
    )
    assert run.record.findings == ()
    assert [path.name for path in run.record.paths] == ["correct", "brake"]
    effects = {effect.path: effect.success.value for effect in run.record.effects}
    assert effects["correct"] > 0
    assert effects["brake"] < 0


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
    assert len(fly(built, variant="guessing")) == len(SCENES)


def test_the_hash_of_a_state_that_holds_an_object_does_not_depend_on_places() -> None:
    def held(name: str, module: str) -> object:
        return type(name, (), {"__module__": module})()

    one, two = held("Craft", "faultpath_system_a1"), held("Craft", "faultpath_system_b2")
    assert hashed({"craft": one, "x": 1.0}) == hashed({"craft": two, "x": 1.0})
    assert hashed({"craft": one}) != hashed({"craft": held("Boat", "faultpath_system_a1")})


def test_a_key_that_the_state_has_not_is_told_with_those_that_it_has():
    sentence = "observes: source 'place': the state has no key 'plce'; it has at, clock"
    with pytest.raises(SystemMistake, match=sentence):
        FunctionPlant(
            start,
            step,
            observes={"place": "plce"},
            action="push",
            steps=6,
            dt_s=0.5,
            succeeded=lambda episode: True,
        )
