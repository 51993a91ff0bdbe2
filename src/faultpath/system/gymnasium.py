"""Gymnasium environments as the plant of a system (extra `gymnasium`, version 1.0 or newer).

Every scene gets a new environment, by id or from a function, which moves only while its episode
lasts.
"""

import re
import sys
from collections.abc import Callable, Mapping
from types import ModuleType
from typing import Any, cast

import gymnasium
import numpy as np
from typing_extensions import override

from faultpath.core.arrays import HostArray
from faultpath.core.error_source import mistake_in
from faultpath.core.errors import SystemMistake
from faultpath.core.streams import generator
from faultpath.core.text import ADDRESS
from faultpath.core.trees import release
from faultpath.system.arguments import check_call, shown
from faultpath.system.episodes import (
    SCENE,
    Episode,
    EpisodePlant,
    Measure,
    SceneInstance,
    Selector,
    Show,
)
from faultpath.system.observed import hashed
from faultpath.system.outcome import Metric

Setup = Callable[[Any, np.random.Generator], Mapping[str, Any] | None]
OnStep = Callable[[Any, np.random.Generator, int], None]

_LOCATION = re.compile(rf"(?<=faultpath_system_)\w*(?=:)|{ADDRESS}")
"""A system's module, which is named after the path of its file, and a function's address in memory:
both differ from machine to machine."""


class GymnasiumPlant(EpisodePlant):
    """Gymnasium environments, side by side.

    Args:
        environment: An id, or a function without arguments that returns one environment.
        observes: Source to its part of the observation: a key, an index, a slice, several of them
            in turn, or a function of the batch's observation.
        action: Channel from which the environment is moved, at the place `actuator`; a reading has
            the action's shape, or is a number where the action is one.
        succeeded: Returns whether a finished episode was a success.
        metrics: Further measures of each finished episode, by name, beside its `return`.
        steps: Control steps of an episode; default the time limit of the environment.
        dt_s: Length of a control step, s; default the `dt` of the environment.
        setup: Called as `setup(env, rng)` for each scene, after its seeded reset, to set model
            parameters and disturbances. The values that it returns by name are sources too, and
            are hashed: two trials whose scenes were set up differently are no pair.
        observation: `observation(env)` returns what modules observe at the start. A `setup` that
            changes that, as by setting the environment's state, needs it; default what the reset
            returned.
        on_step: Called as `on_step(env, rng, step)` before each step, to disturb the scene. `rng`
            gives other numbers at each step and seed, and the same for every variant and condition.
        trace: `trace(env)` returns the position, `(x, y)` or `(x, y, z)` in metres, for the report.
        render: `render(env)` returns points `(x, y)` of a line that draws it, in metres.
    """

    def __init__(
        self,
        environment: str | Callable[[], Any],
        *,
        observes: Mapping[str, Selector],
        action: str,
        succeeded: Callable[[Episode], bool],
        metrics: Mapping[str, Measure] | None = None,
        steps: int | None = None,
        dt_s: float | None = None,
        setup: Setup | None = None,
        observation: Callable[[Any], Any] | None = None,
        on_step: OnStep | None = None,
        trace: Show | None = None,
        render: Show | None = None,
    ) -> None:
        for name, function, arguments in (
            ("setup", setup, "env, rng"),
            ("observation", observation, "env"),
            ("on_step", on_step, "env, rng, step"),
        ):
            if function is not None:
                check_call(name, function, arguments)
        self._environment, self._setup, self._on_step = environment, setup, on_step
        self._limit, self._observation = steps, observation
        self._sample: Any = None
        self._sample = sample = self._make()
        self.identity, self.code = _identity(sample), _code(sample)
        if steps is None:
            steps = getattr(sample.spec, "max_episode_steps", None)
        if dt_s is None:
            dt_s = getattr(sample.unwrapped, "dt", None)
        if setup is not None and observation is None:
            _check_observation(sample, setup)
        sample.close()
        for name, value in {"steps": steps, "dt_s": dt_s}.items():
            if value is None:
                raise SystemMistake(f"GymnasiumPlant: the environment does not say {name}: give it")
        returned = Measure(Metric(unit="1", better="more"), lambda episode: episode.returned)
        super().__init__(
            observes=observes,
            action=action,
            steps=steps or 0,
            dt_s=float(dt_s or 0),
            succeeded=succeeded,
            metrics={"return": returned, **(metrics or {})},
            trace=trace,
            render=render,
        )
        self._sample = None

    @override
    def world(self, scene: str, seed: int) -> SceneInstance:
        digits = scene.removeprefix(SCENE)
        if digits == scene or not digits.isdecimal():
            raise SystemMistake(f"scene '{scene}' names no seed: such scenes are called {SCENE}7")
        env, disturbance = self._make(), "none"
        observation, _ = env.reset(seed=int(digits))
        initial = hashed(scene, observation, env.unwrapped.np_random.bit_generator.state)
        facts: Mapping[str, Any] = {}
        if self._setup:
            rng = generator("environment/setup", scene, 0)
            returned = self._setup(env, rng)
            facts = {} if returned is None else returned
            if not isinstance(cast("Any", facts), Mapping):
                raise mistake_in(
                    self._setup,
                    f"`setup` returned {shown(facts)}: it must return values by name, or nothing",
                )
            disturbance = hashed((sorted(facts.items()), rng.bit_generator.state))
        if self._observation:
            observation = self._observation(env)
            initial = hashed(initial, observation)
        if self._on_step:  # its random numbers are addressed by scene and seed
            disturbance = hashed(disturbance, scene, seed)

        def step(action: HostArray, step: int) -> tuple[Any, float, bool, bool, Mapping[str, Any]]:
            if self._on_step:
                self._on_step(env, generator("environment/step", scene, seed, step), step)
            space = env.action_space
            if space.shape is None:
                raise SystemMistake(
                    f"the environment takes actions of {space}: only arrays can be given"
                )
            if np.issubdtype(space.dtype, np.integer) and np.any(action % 1):
                raise SystemMistake(
                    f"the environment takes whole numbers, {space}, and its action is of "
                    f"{action.dtype}: give integers"
                )
            try:
                row = action.reshape(space.shape).astype(space.dtype)
                if space.dtype.kind in "iu" and np.any(row != action.reshape(space.shape)):
                    raise OverflowError(f"{space.dtype} does not hold the action {action}")
            except ValueError:
                raise SystemMistake(
                    f"the environment takes actions of shape {list(space.shape)}, and one scene's "
                    f"is of shape {list(action.shape)}: correct what writes it"
                ) from None
            return env.step(row[()])

        # Copied, since a part of the model may change in the episode.
        facts = {name: np.array(value) for name, value in facts.items()}
        return SceneInstance(observation, facts, initial, disturbance, step, lambda: env, env.close)

    def _make(self) -> Any:
        if not isinstance(self._environment, str):
            environment = self._environment()
            if environment is self._sample:
                raise mistake_in(
                    self._environment,
                    "the function of the environment returned the same one twice: make a new one "
                    "at each call, since scenes run side by side",
                )
            return environment
        limit: dict[str, Any] = {} if self._limit is None else {"max_episode_steps": self._limit}
        return gymnasium.make(self._environment, **limit)


def _check_observation(env: Any, setup: Setup) -> None:
    """Raise `SystemMistake` where `setup` is seen to change what the reset observed.

    No call of Gymnasium's observes without a step. What shows it is `state`, where environments of
    Gymnasium keep theirs, and `_get_obs`, where it returns the same when it is called twice.
    """

    def read() -> tuple[str, str]:
        inner = env.unwrapped
        try:
            observed = hashed(inner._get_obs())
        except Exception:  # somebody's private function, which may take arguments or be none
            observed = ""
        return hashed(getattr(inner, "state", None)), observed

    env.reset(seed=0)
    first, before = read(), read()
    setup(env, generator("environment/setup", f"{SCENE}0", 0))
    after = read()
    if any(a == b != c for a, b, c in zip(first, before, after, strict=True)):
        call = "env.unwrapped._get_obs()" if after[1] else "..."
        raise SystemMistake(
            "`setup` changes what the environment observes, and its first observation is from "
            "before: give `observation=`, a function of the environment that returns it after "
            f"`setup`, such as lambda env: {call}"
        )


def _identity(env: Any) -> str:
    """Return the spec of an environment, and the packages that its classes use."""
    modules = [sys.modules.get(kind.__module__) for kind in type(env.unwrapped).__mro__]
    values = [value for module in modules if module for value in vars(module).values()]
    used = {value.__name__.partition(".")[0] for value in values if isinstance(value, ModuleType)}
    versions = {name: version for name in sorted(used) if (version := release(name))}
    return f"{_LOCATION.sub('', str(env.spec))} {versions}"


def _code(env: Any) -> tuple[str, ...]:
    """Return the classes of an environment and its wrappers that are not Gymnasium's own.

    An environment that is registered under an id need not be imported by the system, and yet its
    code decides trials. The system's own file is counted elsewhere.
    """
    parts: list[Any] = [env]
    while hasattr(parts[-1], "env"):
        parts.append(parts[-1].env)
    names: dict[str, None] = {}
    for part in parts:
        module = part.__class__.__module__
        known = module.partition(".")[0] == "gymnasium" or module.startswith("faultpath_system_")
        if not known and getattr(sys.modules.get(module), "__spec__", None) is not None:
            names[f"{module}:{part.__class__.__name__}"] = None
    return tuple(names)
