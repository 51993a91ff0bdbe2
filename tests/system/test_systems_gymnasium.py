"""Gymnasium's environments as plants: ends of episodes, scenes, what follows from what runs."""

from functools import partial

import numpy as np
import pytest
from gym_toys import REAL, SCENES, Keyed, Steer, Walk, plant, system, trials
from gymnasium.spaces import Box, Tuple

import faultpath
from faultpath.core.errors import SystemMistake, UserError
from faultpath.loop import Port
from faultpath.run.attempt import Done, Raised, attempt
from faultpath.run.check.blocks import BlockSpec, run_block
from faultpath.run.code import system_code
from faultpath.run.plan import SystemSpec, Treatment
from faultpath.run.registry import load_parts
from faultpath.run.store.signals import DRAWN
from faultpath.system import ComposedSystem, writes
from faultpath.system.checks import UNNAMED
from faultpath.system.episodes import EpisodePlant


def test_a_finished_episode_is_frozen_as_it_ended():
    episodes, clocks = [], []

    @writes("push")
    def watch(place, clock):
        clocks.append(clock.copy())
        return np.clip(0.5 * place, -1, 1)

    seen = plant(observes={"place": 0, "clock": 1}, succeeded=lambda e: episodes.append(e) or True)
    built = system(seen, [watch], units={"clock": "1"})
    clocks.clear()
    ends = [round(o.time_s / 0.5) for o in trials(built)]
    assert all(e.returned == -abs(e["place"][1:]).sum() for e in episodes)
    delivered = np.array(clocks).T.tolist()
    assert delivered == [[min(step, end) for step in range(len(clocks))] for end in ends]


def test_an_environment_of_its_own_is_never_moved_beyond_its_end():
    walks = []

    def make():
        walks.append(Walk())
        return walks[-1]

    built = system(plant(make))
    walks.clear()
    ends = [round(o.time_s / 0.5) for o in trials(built)]
    assert [walk.calls for walk in walks] == [["reset", *["step"] * end] for end in ends]


def test_a_discrete_action_of_which_a_module_reads_the_past_passes_the_check():
    @writes("lean", past="push")
    def predictor(place, push):
        return place + 0.5 * push

    @writes("push", before=0)
    def controller(lean):
        return (lean < 0).astype(int)

    walker = plant(Keyed, observes={"place": ("at", 0)})
    built = system(walker, [predictor, controller], units={"push": "1", "lean": "m"})
    assert not faultpath.check(built, scenes=2, workers=0, progress=False).failures


def test_a_choice_may_be_a_real_number_that_is_whole():
    chosen = writes("push", of=dict)(lambda _, place: 1 if place < 0 else 0)
    chosen.name = "chosen"
    done = attempt(
        system(plant(Keyed, observes={"place": ("at", 0)}), [chosen]),
        Treatment(variant="only"),
        SCENES,
    )
    assert isinstance(done, Done)


class Parts(Walk):
    """The same, with its observation in parts and an action of small whole numbers."""

    observation_space = Tuple((REAL, Box(-np.inf, np.inf, (2,), np.float64)))
    action_space = Box(0, 255, (1,), np.uint8)

    def step(self, action):
        return super().step(action / 255)

    def _seen(self):
        return self.at, np.array([self.step_count, 2.0 * self.at])


@pytest.mark.parametrize("size", [255, 300])
def test_a_part_of_a_tuple_is_observed_and_an_action_too_large_for_its_type_fails(size):
    @writes("push")
    def mover(place, twice):
        assert np.array_equal(twice, 2 * place)
        return np.full(len(place), size)

    built = system(
        plant(Parts, observes={"place": 0, "twice": (1, 1)}), [mover], units={"twice": "m"}
    )
    done = attempt(built, Treatment(variant="only"), SCENES)
    assert isinstance(done, Done if size == 255 else Raised)
    assert size == 255 or done.error == "OverflowError: uint8 does not hold the action 300"


def test_what_runs_is_the_interface():
    def setup(env, rng):
        env.unwrapped.slope = rng.uniform(-0.1, 0.1)
        return {"slope": env.unwrapped.slope}

    class Knowing(Steer):
        reads = frozenset({Port("place", "feedback"), Port("slope", "model")})

    built = system(plant(setup=setup, observes={"place": slice(0, 1)}), [Knowing()])
    sources = {s.name: (s.shape, s.unit, s.provenance.value) for s in built.interface.sources}
    assert sources == {
        "place": ((1,), "m", "measured"),
        "push": ((1,), "m", "commanded"),
        "slope": ((), "m", "estimated"),
    }
    assert built.interface.channel("slope").gap == "fidelity"
    assert built.variants["only"].readers == {"steer.feedback", "steer.model", "plant.actuator"}


def test_scenes_set_up_in_another_way_are_no_pair():
    def setup(width, env, rng):
        env.unwrapped.slope = rng.uniform(-width, width)

    def disturbances(width):
        return [o.disturbance_hash for o in trials(system(plant(setup=partial(setup, width))))]

    def drawn_twice(env, rng):
        setup(0.1, env, rng)
        rng.uniform()

    assert disturbances(0.1) == disturbances(0.1)
    assert len(set(disturbances(0.1))) == len(SCENES)
    twice = [o.disturbance_hash for o in trials(system(plant(setup=drawn_twice)))]
    assert not set(twice) & set(disturbances(0.1))


class Observed(Walk):
    """A walker that says what it observes, as Gymnasium's pendulum does."""

    def _get_obs(self):
        return self._seen()


class Stated(Walk):
    """One that keeps its state in `state`, as Gymnasium's cart does."""

    state = property(lambda self: (self.at,))


def moved(env, rng):
    env.unwrapped.at = 2 + rng.uniform(0, 0.5)


def sloped(env, rng):
    env.unwrapped.slope = rng.uniform(-0.1, 0.1)


def test_a_value_of_the_set_up_stays_as_it_was_when_the_model_changes():
    def loaded(env, rng):
        env.unwrapped.load = np.ones(2)
        return {"slope": env.unwrapped.load}

    def lose(env, rng, step):
        env.unwrapped.load[:] = 0.0

    episodes = []
    done = plant(setup=loaded, on_step=lose, succeeded=lambda e: bool(episodes.append(e)))
    trials(system(done, units={"slope": "kg"}))
    assert [episode["slope"].min() for episode in episodes] == [1.0] * len(SCENES)


def test_modules_begin_with_what_is_observed_after_the_set_up():
    built = plant(Observed, setup=moved, observation=lambda env: env.unwrapped._get_obs())
    world = built.world(SCENES[0], 0)
    assert world.observation[0] == world.view().unwrapped.at > 2
    other = plant(Observed, setup=sloped, observation=lambda env: env.unwrapped._get_obs())
    assert world.initial != other.world(SCENES[0], 0).initial


@pytest.mark.parametrize(("environment", "call"), [(Observed, r"env\..*_get_obs"), (Stated, r"\.")])
def test_a_set_up_that_outdates_the_first_observation_is_refused(environment, call) -> None:
    with pytest.raises(SystemMistake, match=f"`observation=`, .* such as lambda env: {call}"):
        plant(environment, setup=moved)
    plant(environment, setup=sloped)


def test_what_disturbs_a_step_is_drawn_by_scene_seed_and_step():
    drawn = []

    def gust(env, rng, step):
        env.unwrapped.slope = rng.uniform(-0.5, 0.5)
        drawn.append((env.unwrapped.slope, step))

    built = system(plant(on_step=gust))
    drawn.clear()
    first = trials(built, SCENES[:1])
    alone = drawn.copy()
    assert [step for _, step in alone] == list(range(len(alone)))
    assert len({slope for slope, _ in alone}) == len(alone) > 1
    drawn.clear()
    both = trials(built, SCENES[1::-1])
    assert both[1] == first[0]
    assert set(alone) < set(drawn)
    drawn.clear()
    again = trials(built, SCENES[:1], seed=1)
    assert not set(alone) & set(drawn)
    assert again[0].disturbance_hash != first[0].disturbance_hash


def test_what_is_traced_and_rendered_is_kept_for_the_player():
    def rod(env):
        return [(0, 0), (env.unwrapped.at, 1)]

    built = system(
        plant(trace=lambda env: [env.unwrapped.at], render=rod, observes={"place": slice(0, 2)}),
        units={"place": {"unit": "m, 1", "components": ("where", "clock")}},
        modules=[Ahead()],
    )
    block = run_block(built, BlockSpec(Treatment(variant="only", seed=0), SCENES[:2], signals=True))
    for outcome, signals in zip(block.outcomes, block.signals, strict=True):
        named = {each.name: each for each in signals}
        assert named["place"].parts == ("where", "clock")
        assert np.array_equal(named[DRAWN].values[:, 2], named["place"].values[:, 0])
        assert np.array_equal(outcome.trace[:-1, 0], named["place"].values[:, 0])
        assert named[DRAWN].values.shape[1] == 4


def test_libraries_are_seeds_and_a_single_one_is_taken_where_none_is_named():
    built = system(plant(), scenes={"some": range(5, 8)})
    library = built.library("some")
    assert [scene.id for scene in library.scenes] == ["seed/5", "seed/6", "seed/7"]
    other = system(plant(), scenes={"some": range(6, 9)}).library("some")
    assert library.content_hash != other.content_hash
    several = system(plant(), scenes={"some": range(5, 8), "more": range(9)})
    for default in UNNAMED:
        assert built.library(default) == library
        with pytest.raises(UserError, match=f"unknown library '{default}'; known: more, some"):
            several.library(default)


class Ahead(Steer):
    def step(self, inputs, memory):
        return {"push": 0.1 * inputs["place", "feedback"][:, 0]}, memory


def measured(units):
    return ComposedSystem("walk", plant(), {"only": [Steer()]}, units)


@writes("push")
def whole(place):
    return np.zeros((len(place), 2))


@writes("push")
def look(eye):
    return eye[:, 0]


@writes("push", past="push")
def again(place, push):
    return push


ONE = Walk()


def slope_of_some(env, rng):
    return {} if env.unwrapped.at > 0.2 else {"slope": 0.0}


@pytest.mark.parametrize(
    ("make", "sentence"),
    [
        (lambda: plant(observes={"place": 7}), "holds no such part"),
        (lambda: plant(observes={"place": "at"}), "holds no such part"),
        (
            lambda: plant(Keyed, observes={"place": "to"}),
            "the observation has no key 'to'; it has ",
        ),
        (lambda: plant(dt_s=None, environment="CartPole-v1"), "does not say dt_s: give it"),
        (lambda: plant(steps=None), "does not say steps: give it"),
        (lambda: measured({}), "'place' has no unit"),
        (lambda: measured({"plce": "m"}), "units names 'plce', which is no .*did you mean 'place'"),
        (lambda: system(plant(), [look]), "'look': unknown source 'eye'; known:"),
        (lambda: system(plant(), [again]), "before the first step"),
        (lambda: trials(system(plant(), [whole])), r"shape \[1\], and.* of shape \[2\]"),
        (
            lambda: trials(system(plant(Keyed, observes={"place": ("at", 0)}))),
            "whole numbers.*float",
        ),
        (lambda: trials(system(plant(succeeded=lambda e: None))), "returned None of an episode"),
        (lambda: trials(system(plant(succeeded=lambda e: e["x"]))), "unknown source 'x'"),
        (lambda: trials(system(plant()), ["a"]), "scene 'a' names no seed"),
        (
            lambda: system(plant(), units={"place": {"unit": "m", "components": ("a", "b")}}),
            "'place' has 2 components",
        ),
        (lambda: trials(system(plant(trace=lambda env: []))), "`trace` returned 0 numbers"),
        (lambda: plant(steps=0), "steps is 0: give a whole number of at least 1"),
        (lambda: plant(lambda: ONE), "returned the same one twice: make a new one at each call"),
        (lambda: plant(setup=lambda env, rng: 1.0), "`setup` returned 1.0: it must return values"),
        (
            lambda: trials(system(plant(setup=slope_of_some))),
            "set-up of scene 'seed/1' returned slope, and that of 'seed/0' none",
        ),
    ],
)
def test_mistakes_are_told_in_a_sentence(make, sentence):
    with pytest.raises(SystemMistake, match=sentence):
        make()


def test_the_code_of_an_environment_that_nobody_imports_counts(tmp_path, monkeypatch):
    monkeypatch.syspath_prepend(tmp_path)
    (tmp_path / "their_walk.py").write_text(
        "import gymnasium\nfrom gym_toys import Walk\n"
        "class Theirs(Walk): pass\n"
        "gymnasium.register('Theirs-v0', lambda: Theirs(), max_episode_steps=30)\n"
    )
    built = system(plant("their_walk:Theirs-v0", steps=None))
    assert built.plant().steps == 30
    code = system_code(built, SystemSpec(name="examples/pendulum.py:create"))
    assert any(name.endswith("their_walk.py") for name in code.state.files)
    assert "Theirs-v0" in built.fingerprint()


WRAPPED = """
import gymnasium
from gymnasium.wrappers import TransformReward
from faultpath.system.gymnasium import GymnasiumPlant

class Own(gymnasium.Wrapper, gymnasium.utils.RecordConstructorArgs):
    def __init__(self, env, law):
        gymnasium.utils.RecordConstructorArgs.__init__(self, law=law)
        super().__init__(env)

def made() -> GymnasiumPlant:
    return GymnasiumPlant(
        lambda: Own(TransformReward(gymnasium.make("Pendulum-v1"), abs), lambda reward: reward),
        observes={"angle": 0}, action="torque", succeeded=bool, dt_s=0.05,
    )
"""


def test_scenes_are_the_same_wherever_the_file_of_a_system_lies(tmp_path):
    """Their hash is in records; with another one a run could be run again in its folder only."""
    plants = []
    for folder in ("here", "there"):
        (tmp_path / folder).mkdir()
        (tmp_path / folder / "wrapped.py").write_text(WRAPPED)
        plants += load_parts([f"{tmp_path / folder / 'wrapped.py'}:made"], (EpisodePlant,)).values()
    here, there = (make().identity for make in plants)
    assert "faultpath_system_:Own" in here
    assert "function" in here
    assert here == there
