"""Gymnasium's environments as the plant of a system (extra `gymnasium`, version 1.0 or newer).

An environment of one's own, by id or by a function that makes it, is made anew for every scene, and
moved only while its episode lasts. A vector environment is taken as it comes, in any of the three
modes of autoreset: what it does after the end of an episode is not looked at.
"""

from collections.abc import Callable, Mapping, Sequence
from typing import Any, cast

import gymnasium
import numpy as np
from typing_extensions import override

from faultpath.arrays import HostArray
from faultpath.errors import SystemMistake
from faultpath.loop import Batch
from faultpath.streams import generator
from faultpath.systems.environments import code, identity
from faultpath.systems.episodes import (
    RETURN,
    Episode,
    EpisodePlant,
    Look,
    Measure,
    Stepped,
    Worlds,
    hashed,
    seed_of,
    stacked,
)

Setup = Callable[[Any, np.random.Generator], Mapping[str, Any] | None]


class GymnasiumPlant(EpisodePlant):
    """Environments of Gymnasium, side by side.

    Args:
        environment: An id, or a function without arguments that returns one environment.
        observes: Source to its part of the observation: a key, an index, a slice, several of them
            in turn, or a function of the batch's observation.
        action: Channel from which the environment is moved, at the place `actuator`; a reading has
            the action's shape, or is a number where the action is one.
        succeeded: Says of each finished episode whether it was a success.
        metrics: What else is measured of each finished episode, by name, beside its `return`.
        steps: Control steps of an episode; default the time limit of the environment.
        dt_s: Length of a control step, s; default the `dt` of the environment.
        setup: Called as `setup(env, rng)` for each scene, after its seeded reset, to set model
            parameters and disturbances. What it returns by name are sources too. It is hashed:
            two trials whose scenes were set up in another way are no pair.
        vector: In place of `environment`, a function of a number that returns a vector environment
            of so many.
    """

    def __init__(
        self,
        environment: str | Callable[[], Any] | None = None,
        *,
        observes: Mapping[str, Look],
        action: str,
        succeeded: Callable[[Episode], bool],
        metrics: Mapping[str, Measure] | None = None,
        steps: int | None = None,
        dt_s: float | None = None,
        setup: Setup | None = None,
        vector: Callable[[int], Any] | None = None,
    ) -> None:
        if (environment is None) == (vector is None):
            raise SystemMistake("GymnasiumPlant: give an environment, or else a vector of them")
        self._environment, self._vector, self._setup = environment, vector, setup
        self._limit = steps
        sample = vector(1) if vector else self._make()
        self._identity, self._code = identity(sample), code(sample)
        single = getattr(sample.unwrapped, "envs", [sample])[0]
        steps = steps or getattr(single.spec, "max_episode_steps", None)
        dt_s = dt_s or getattr(single.unwrapped, "dt", None)
        sample.close()
        for what, found in {"steps": steps, "dt_s": dt_s}.items():
            if not found:
                raise SystemMistake(f"GymnasiumPlant: the environment does not say {what}: give it")
        super().__init__(
            observes=observes,
            action=action,
            steps=int(steps or 0),
            dt_s=float(dt_s or 0),
            succeeded=succeeded,
            metrics=RETURN | dict(metrics or {}),
        )

    @override
    def worlds(self, batch: Batch) -> Worlds:
        seeds = [seed_of(name) for name in batch.scenes]
        if self._vector is not None:
            return _VectorWorlds(self._vector(len(seeds)), batch, seeds, self._setup)
        return _SingleWorlds([self._make() for _ in seeds], batch, seeds, self._setup)

    @override
    def identity(self) -> str:
        return self._identity

    @override
    def code(self) -> Sequence[str]:
        return self._code

    def _make(self) -> Any:
        if not isinstance(self._environment, str):
            assert self._environment is not None
            return self._environment()
        if self._limit is None:
            return gymnasium.make(self._environment)
        return gymnasium.make(self._environment, max_episode_steps=self._limit)


class _GymnasiumWorlds(Worlds):
    """What single environments and vector ones have in common: set-up, hashes and actions."""

    def __init__(
        self, space: Any, batch: Batch, envs: Sequence[Any], observed: Any, setup: Setup | None
    ) -> None:
        self._space = space
        told: list[Mapping[str, Any]] = []
        self.initial, self.disturbances = [], []
        for i, name in enumerate(batch.scenes):
            env = envs[i] if envs else None
            self.initial.append(hashed(name, _row(observed, i), _stream(env)))
            rng = generator("environment/setup", name, 0)
            found = setup(env, rng) if setup else None
            told.append({} if found is None else found)
            done = (sorted(told[-1].items()), rng.bit_generator.state)
            self.disturbances.append(hashed(done) if setup else "none")
        self.observation = observed
        self.told = {name: np.array([np.asarray(t[name]) for t in told]) for name in told[0]}

    def _action(self, action: HostArray) -> HostArray:
        space = self._space
        if space.shape is None:
            raise SystemMistake(
                f"the environment takes actions of {space}: only arrays can be told"
            )
        if np.issubdtype(space.dtype, np.integer) and action.dtype.kind not in "biu":
            raise SystemMistake(
                f"the environment takes whole numbers, {space}, and its action is of "
                f"{action.dtype}: give integers"
            )
        try:
            return action.reshape(len(action), *space.shape).astype(space.dtype)
        except ValueError:
            raise SystemMistake(
                f"the environment takes actions of shape {list(space.shape)}, and one scene's is "
                f"of shape {list(action.shape[1:])}: mend what writes it"
            ) from None


class _SingleWorlds(_GymnasiumWorlds):
    """An environment for each scene, left alone once its episode has ended."""

    def __init__(
        self, envs: Sequence[Any], batch: Batch, seeds: Sequence[int], setup: Setup | None
    ) -> None:
        self._envs = envs
        self._last = [env.reset(seed=seed)[0] for env, seed in zip(envs, seeds, strict=True)]
        super().__init__(envs[0].action_space, batch, envs, stacked(self._last), setup)

    @override
    def step(self, action: HostArray, running: HostArray, step: int) -> Stepped:
        rows = self._action(action)
        rewards, ends = np.zeros(len(rows)), np.zeros((2, len(rows)), bool)
        said: list[Mapping[str, Any]] = [{} for _ in rows]
        for i in map(int, np.flatnonzero(running)):
            found: Any = self._envs[i].step(rows[i])
            self._last[i], rewards[i], ends[0, i], ends[1, i], said[i] = found
        return Stepped(stacked(self._last), rewards, ends[0], ends[1], said.__getitem__)

    @override
    def close(self) -> None:
        for env in self._envs:
            env.close()


class _VectorWorlds(_GymnasiumWorlds):
    """A vector environment, which goes on after the end of an episode in a way of its own."""

    def __init__(self, envs: Any, batch: Batch, seeds: Sequence[int], setup: Setup | None) -> None:
        self._envs, self._mode = envs, _mode(envs)
        if envs.num_envs != len(seeds):
            raise SystemMistake(
                f"`vector` was asked for {len(seeds)} environments and returned {envs.num_envs}"
            )
        single = getattr(envs.unwrapped, "envs", ())
        if setup and not single:
            raise SystemMistake(
                "setup needs each environment by itself, and this vector has no `envs`: give a "
                "single `environment`, or set up what `vector` makes"
            )
        try:
            observed, _ = envs.reset(seed=list(seeds))
        except (gymnasium.error.Error, TypeError, ValueError) as error:
            raise SystemMistake(
                f"the vector environment takes no list of seeds, one a scene ({error}), so a scene "
                "would depend on the scenes beside it: give a single `environment`"
            ) from error
        super().__init__(envs.single_action_space, batch, single, observed, setup)
        self._over = np.zeros(len(seeds), bool)

    @override
    def step(self, action: HostArray, running: HostArray, step: int) -> Stepped:
        if self._mode == "Disabled" and self._over.any():
            # It may not be stepped beyond its end. What it does from here on is nobody's episode.
            self._envs.reset(options={"reset_mask": self._over})
        seen, rewards, terminated, truncated, info = self._envs.step(self._action(action))
        self._over = np.asarray(terminated) | np.asarray(truncated)
        if self._mode != "SameStep" or not self._over.any():
            return Stepped(seen, rewards, terminated, truncated, lambda i: _said(info, i))
        rows = [_row(info["final_obs"] if over else seen, i) for i, over in enumerate(self._over)]
        final = info.get("final_info", info)
        return Stepped(stacked(rows), rewards, terminated, truncated, lambda i: _said(final, i))

    @override
    def close(self) -> None:
        self._envs.close()


def _mode(envs: Any) -> str:
    """Return what a vector environment does after the end of an episode.

    Gymnasium 1.0 knew one way and did not name it.
    """
    unnamed = "NextStep" if gymnasium.__version__.startswith("1.0.") else None
    found = envs.metadata.get("autoreset_mode", unnamed)
    mode = getattr(found, "value", found)
    if mode not in ("NextStep", "SameStep", "Disabled"):
        raise SystemMistake(
            f"metadata['autoreset_mode'] of the vector environment is {found!r}: it must be an "
            "AutoresetMode of gymnasium.vector, or the end of an episode cannot be told"
        )
    return mode


def _row(batch: Any, i: int) -> Any:
    if isinstance(batch, Mapping):
        return {key: _row(value, i) for key, value in cast("Mapping[Any, Any]", batch).items()}
    if isinstance(batch, tuple):
        return tuple(_row(value, i) for value in cast("tuple[Any, ...]", batch))
    return batch[i]


def _said(info: Mapping[str, Any], i: int) -> Mapping[str, Any]:
    return {
        key: _row(value, i)
        for key, value in info.items()
        if not key.startswith("_") and np.all(np.asarray(info.get(f"_{key}", True))[..., i])
    }


def _stream(env: Any) -> Any:
    return None if env is None else env.unwrapped.np_random.bit_generator.state
