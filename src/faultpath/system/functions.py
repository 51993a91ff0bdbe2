"""Plain functions as the plant of a system: one that starts a scene, one that makes a step."""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from typing_extensions import override

from faultpath.core.arrays import HostArray
from faultpath.core.errors import SystemMistake
from faultpath.core.streams import generator
from faultpath.system.arguments import check_call, truth_of
from faultpath.system.episodes import Episode, EpisodePlant, Look, Measure, SceneInstance, Show
from faultpath.system.observed import hashed


class FunctionPlant(EpisodePlant):
    """A plant of two functions of one scene.

    Args:
        start: `start(rng)` returns the state at the start of a scene: an array, or numbers and
            arrays by name. Whatever makes one scene another is drawn from `rng`.
        step: `step(state, action, rng)` returns the state one control step later. It
            draws other numbers at each step and seed, and the same for every
            variant and condition.
        observes: Source to its part of the state: a name, an index, a slice, several of them in
            turn, or a function of the batch's state.
        action: Channel from which the plant is moved, at the place `actuator`.
        steps: Control steps of an episode.
        dt_s: Length of a control step, s.
        succeeded: Says of each finished episode whether it was a success.
        metrics: Further measures of each finished episode, by name.
        over: `over(state)` says of the state of one scene, true or false, whether it ends before
            its time; without it none does.
        trace: `trace(state)` returns where it is, `(x, y)` or `(x, y, z)` in metres.
        render: `render(state)` returns points `(x, y)` of a line that draws it, in metres.
    """

    def __init__(
        self,
        start: Callable[[np.random.Generator], Any],
        step: Callable[[Any, HostArray, np.random.Generator], Any],
        *,
        observes: Mapping[str, Look],
        action: str,
        steps: int,
        dt_s: float,
        succeeded: Callable[[Episode], bool],
        metrics: Mapping[str, Measure] | None = None,
        over: Callable[[Any], bool] | None = None,
        trace: Show | None = None,
        render: Show | None = None,
    ) -> None:
        check_call("start", start, "rng")
        check_call("step", step, "state, action, rng")
        if over is not None:
            check_call("over", over, "state")
        self._start, self._step, self._over = start, step, over
        super().__init__(
            observes=observes,
            action=action,
            steps=steps,
            dt_s=dt_s,
            succeeded=succeeded,
            metrics=metrics,
            trace=trace,
            render=render,
        )

    observed = "the state"

    @override
    def world(self, scene: str, seed: int) -> SceneInstance:
        state = _given("start", self._start(generator("plant/start", scene, 0)))

        def step(action: HostArray, step: int) -> tuple[Any, float, bool, bool, dict[str, Any]]:
            nonlocal state
            draws = generator("plant/step", scene, seed, step)
            state = _given("step", self._step(state, action, draws))
            over = self._over
            ends = over is not None and truth_of(
                "over", over, over(state), "the state of one scene"
            )
            return state, 0.0, ends, False, {}

        # What a step draws is addressed by scene and seed, so these are all that decides it.
        return SceneInstance(state, {}, hashed(state), hashed(scene, seed), step, lambda: state)


def _given(name: str, state: Any) -> Any:
    if state is None:
        raise SystemMistake(f"`{name}` returned nothing: it must return the state")
    return state
