"""Gymnasium's environments as plants: ends of episodes, scenes, what follows from what runs."""

from functools import partial
from pathlib import Path

import numpy as np
import pytest
from gym_toys import SCENES, Keyed, Steer, Walk, fly, plant, system

import faultpath
from faultpath.core.errors import SystemMistake, UserError
from faultpath.loop import Module, Port
from faultpath.systems import ComposedSystem, Parts
from faultpath.systems.checks.blocks import BlockSpec, run_block
from faultpath.systems.episodes import EpisodePlant
from faultpath.trials import Arm, SystemSpec
from faultpath.trials.checks import UNNAMED
from faultpath.trials.code import system_code
from faultpath.trials.registry import load_parts
from faultpath.trials.store.signals import DRAWN

PENDULUM = Path(__file__).resolve().parents[2] / "examples" / "pendulum.py"


class Choose(Module):
    """Goes left or right; its readings have two axes of their own."""

    name, writes = "choose", ("push",)
    reads = frozenset({Port("place", "feedback"), Port("eye", "look")})

    def step(self, inputs, memory):
        return {"push": (inputs["place", "feedback"] < 0).astype(int)}, memory


def test_a_finished_episode_is_frozen_as_it_ended():
    episodes = []

    def note(episode):
        episodes.append(episode)
        return True

    seen = {"observes": {"place": 0, "clock": 1}, "succeeded": note}
    units = {"units": {"clock": "1"}}

    class Watch(Steer):
        reads = frozenset({Port("place", "feedback"), Port("clock", "watch")})
        clocks = []  # noqa: RUF012 - one list for the one batch that is watched

        def step(self, inputs, memory):
            self.clocks.append(inputs["clock", "watch"].copy())
            return super().step(inputs, memory)

    built = system(plant(**seen), [Watch()], **units)
    Watch.clocks.clear()
    ends = [round(o.time_s / 0.5) for o in fly(built)]
    assert sorted(len(e.rewards) for e in episodes) == sorted(ends)
    assert all(list(e["clock"]) == list(range(len(e.rewards) + 1)) for e in episodes)
    assert all(e.returned == -abs(e["place"][1:]).sum() for e in episodes)
    clocks = np.array(Watch.clocks)
    assert clocks.T.tolist() == [[min(step, end) for step in range(len(clocks))] for end in ends]


def test_an_environment_of_its_own_is_never_moved_beyond_its_end():
    made = []

    def make():
        made.append(Walk())
        return made[-1]

    built = system(plant(make))
    made.clear()
    ends = [round(o.time_s / 0.5) for o in fly(built)]
    assert [each.calls for each in made] == [["reset", *["step"] * end] for end in ends]


def test_a_scene_does_not_depend_on_the_scenes_beside_it():
    built, mixed = system(plant()), [SCENES[i] for i in (4, 0, 3)]
    by_scene = {o.scene: o for o in fly(built)}
    assert fly(built, mixed) == [by_scene[scene] for scene in mixed]


def test_what_runs_is_the_interface():
    def setup(env, rng):
        env.unwrapped.slope = rng.uniform(-0.1, 0.1)
        return {"slope": env.unwrapped.slope}

    class Knowing(Steer):
        reads = frozenset({Port("place", "feedback"), Port("slope", "model")})

    built = system(plant(setup=setup, observes={"place": slice(0, 1)}), [Knowing()])
    found = {s.name: (s.shape, s.unit, s.provenance.value) for s in built.interface.sources}
    assert found == {
        "place": ((1,), "m", "measured"),
        "push": ((1,), "m", "commanded"),
        "slope": ((), "m", "estimated"),
    }
    assert built.interface.channel("slope").gap == "fidelity"
    assert built.variants["only"].consumers == {"steer.feedback", "steer.model", "plant.actuator"}


def test_scenes_set_up_in_another_way_are_no_pair():
    def setup(width, env, rng):
        env.unwrapped.slope = rng.uniform(-width, width)

    def disturbances(width):
        return [o.disturbance_hash for o in fly(system(plant(setup=partial(setup, width))))]

    def drawn_twice(env, rng):
        setup(0.1, env, rng)
        rng.uniform()

    assert disturbances(0.1) == disturbances(0.1)
    assert len(set(disturbances(0.1))) == len(SCENES)
    twice = [o.disturbance_hash for o in fly(system(plant(setup=drawn_twice)))]
    assert not set(twice) & set(disturbances(0.1))


def test_what_disturbs_a_step_is_drawn_by_scene_seed_and_step():
    drawn = []

    def gust(env, rng, step):
        env.unwrapped.slope = rng.uniform(-0.5, 0.5)
        drawn.append((env.unwrapped.slope, step))

    built = system(plant(on_step=gust))
    drawn.clear()
    first = fly(built, SCENES[:1])
    alone = drawn.copy()
    assert [step for _, step in alone] == list(range(len(alone)))
    assert len({slope for slope, _ in alone}) == len(alone) > 1
    drawn.clear()
    both = fly(built, SCENES[1::-1])
    assert both[1] == first[0]
    assert set(alone) < set(drawn)
    drawn.clear()
    again = fly(built, SCENES[:1], seed=1)
    assert not set(alone) & set(drawn)
    assert again[0].disturbance_hash != first[0].disturbance_hash


def test_what_is_traced_and_rendered_is_kept_for_the_player():
    def rod(env):
        return [(0, 0), (env.unwrapped.at, 1)]

    made = system(
        plant(trace=lambda env: [env.unwrapped.at], render=rod, observes={"place": slice(0, 2)}),
        units={"place": {"unit": "m, 1", "components": ("where", "clock")}},
        modules=[Ahead()],
    )
    found = run_block(made, BlockSpec(Arm(variant="only", seed=0), SCENES[:2], signals=True))
    for outcome, signals in zip(found.outcomes, found.signals, strict=True):
        named = {each.name: each for each in signals}
        assert named["place"].parts == ("where", "clock")
        assert np.array_equal(named[DRAWN].values[:, 2], named["place"].values[:, 0])
        assert np.array_equal(outcome.trace[:-1, 0], named["place"].values[:, 0])
        assert named[DRAWN].values.shape[1] == 4


def test_several_sources_of_a_channel_and_the_one_that_a_variant_writes():
    class Guess(Module):
        name, writes, reads = "guess", ("guessed",), frozenset({Port("clock", "model")})

        def step(self, inputs, memory):
            return {"guessed": 0.0 * inputs["clock", "model"]}, memory

    built = ComposedSystem(
        "walk",
        plant(observes={"seen": 0, "clock": 1}),
        {"seeing": Parts("", [Steer()]), "guessing": Parts("", [Guess(), Steer()])},
        {"seen": "m", "guessed": "m", "clock": "1", "push": "m"},
        channels={"place": ("seen", "guessed")},
    )
    assert built.variants["seeing"].bindings == {"place": "seen"}
    assert built.variants["guessing"].bindings == {"place": "guessed"}
    assert built.interface.reconstructs == {"guess": ("guessed",)}


def test_libraries_are_seeds():
    built = system(plant(), scenes={"some": range(5, 8)})
    library = built.library("some")
    assert [scene.id for scene in library.scenes] == ["seed/5", "seed/6", "seed/7"]
    other = system(plant(), scenes={"some": range(6, 9)}).library("some")
    assert library.content_hash != other.content_hash
    with pytest.raises(UserError, match="unknown library 'training'; known: some"):
        built.library("training")


@pytest.mark.parametrize("default", UNNAMED)
def test_a_single_library_is_the_one_where_none_is_named(default):
    built = system(plant(), scenes={"some": range(5, 8)})
    assert built.library(default) == built.library("some")
    several = system(plant(), scenes={"some": range(5, 8), "more": range(9)})
    with pytest.raises(UserError, match=f"unknown library '{default}'; known: more, some"):
        several.library(default)


class Ahead(Steer):
    def step(self, inputs, memory):
        return {"push": 0.1 * inputs["place", "feedback"][:, 0]}, memory


class Whole(Steer):
    def step(self, inputs, memory):
        return {"push": np.zeros((len(inputs["place", "feedback"]), 2))}, memory


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda: plant(observes={"place": 7}), "holds no such part"),
        (lambda: plant(observes={"place": "at"}), "holds no such part"),
        (
            lambda: plant(Keyed, observes={"place": "to"}),
            "observes: source 'place': the observation has no key 'to'; it has ",
        ),
        (lambda: plant(dt_s=None, environment="CartPole-v1"), "does not say dt_s: give it"),
        (lambda: plant(steps=None), "does not say steps: give it"),
        (lambda: ComposedSystem("walk", plant(), {"only": [Steer()]}, {}), "'place' has no unit"),
        (
            lambda: ComposedSystem("walk", plant(), {"only": [Steer()]}, {"plce": "m"}),
            "units names 'plce', which is no source; did you mean 'place'",
        ),
        (lambda: system(plant(), modules=[Choose()]), "'choose': unknown source 'eye'; known:"),
        (lambda: fly(system(plant(), [Whole()])), r"shape \[1\], and.* of shape \[2\]"),
        (
            lambda: fly(system(plant(Keyed, observes={"place": ("at", 0)}))),
            "whole numbers.*float64",
        ),
        (lambda: fly(system(plant(succeeded=lambda e: None))), "returned None of an episode"),
        (lambda: fly(system(plant(succeeded=lambda e: e["x"]))), "unknown source 'x'"),
        (lambda: fly(system(plant()), ["a"]), "scene 'a' names no seed"),
        (
            lambda: system(plant(), units={"place": {"unit": "m", "components": ("a", "b")}}),
            r"'place' has 2 components and is of shape \[\]",
        ),
        (lambda: fly(system(plant(trace=lambda env: []))), "`trace` returned 0 numbers"),
    ],
)
def test_mistakes_are_told_in_a_sentence(make, said):
    with pytest.raises(SystemMistake, match=said):
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
from faultpath.systems.gymnasium import GymnasiumPlant

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
    """Their hash is in records; with another one a run could be flown again in its folder only."""
    made = []
    for folder in ("here", "there"):
        (tmp_path / folder).mkdir()
        (tmp_path / folder / "wrapped.py").write_text(WRAPPED)
        made += load_parts([f"{tmp_path / folder / 'wrapped.py'}:made"], (EpisodePlant,)).values()
    here, there = (make().identity for make in made)
    assert "faultpath_system_:Own" in here
    assert "function" in here
    assert here == there


def test_the_pendulums_repair_helps_against_the_isolated_fault_and_hurts_under_the_shared(tmp_path):
    run = faultpath.audit(
        PENDULUM,
        baseline="calibrated",
        repair="nominal",
        fault="motor_gain:scale=0.8",
        library="training",
        scenes=20,
        metric="offset_m",
        thresholds=(0.05, 0.02),
        workers=0,
        folder=tmp_path / "run",
        progress=False,
    )
    assert run.failed == 0
    assert run.record.findings == ()
    effects = {effect.path: effect.success.value for effect in run.record.effects}
    assert effects["filter"] > 0 > effects["shared"]
    metrics = {effect.path: effect.metrics for effect in run.record.effects}
    assert metrics["filter"]["offset_m"].value < 0 < metrics["shared"]["offset_m"].value
    assert metrics["shared"]["offset_m"].unit == "m"
    offsets = run.table().to_pylist()
    assert {row["status"] == "success" for row in offsets if row["offset_m"] <= 0.05} == {True}
    for effect in run.record.effects:
        narrow, as_it_is = effect.thresholds
        assert (narrow.threshold, as_it_is.threshold) == (0.02, 0.05)
        assert narrow.repair_percent <= as_it_is.repair_percent == effect.repair_percent
        assert as_it_is.baseline_percent == effect.baseline_percent
        assert as_it_is.difference.value == effect.success.value
    assert "min_clearance_m" not in run.table().column_names
