"""Plain functions as the plant of a system: one that starts a scene, one that makes a step."""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from typing_extensions import override

from faultpath.core.arrays import HostArray
from faultpath.core.error_source import mistake_in
from faultpath.core.streams import generator
from faultpath.system.arguments import boolean_of, check_call
from faultpath.system.episodes import Episode, EpisodePlant, Measure, SceneInstance, Selector, Show
from faultpath.system.observed import hashed


class FunctionPlant(EpisodePlant):
    """A plant of two functions of one scene.

    Args:
        start: `start(rng)` returns the state at the start of a scene: an array, or numbers and
            arrays by name. Everything in which scenes differ is drawn from `rng`.
        step: `step(state, action, rng)` returns the state one control step later. `rng` gives other
            numbers at each step and seed, and the same for every variant and condition.
        observes: Source to its part of the state: a name, an index, a slice, several of them in
            turn, or a function of the batch's state.
        action: Channel from which the plant is moved, at the place `actuator`.
        steps: Control steps of an episode.
        dt_s: Length of a control step, s.
        succeeded: Returns whether a finished episode was a success.
        metrics: Further measures of each finished episode, by name.
        over: `over(state)` returns whether one scene ends early, true or false, from its state;
            without it none does.
        trace: `trace(state)` returns the position, `(x, y)` or `(x, y, z)` in metres.
        render: `render(state)` returns points `(x, y)` of a line that draws it, in metres.
    """

    def __init__(
        self,
        start: Callable[[np.random.Generator], Any],
        step: Callable[[Any, HostArray, np.random.Generator], Any],
        *,
        observes: Mapping[str, Selector],
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
        state = _returned("start", self._start, generator("plant/start", scene, 0))

        def step(action: HostArray, step: int) -> tuple[Any, float, bool, bool, dict[str, Any]]:
            nonlocal state
            draws = generator("plant/step", scene, seed, step)
            state = _returned("step", self._step, state, action, draws)
            over = self._over
            ends = over is not None and boolean_of(
                "over", over, over(state), "the state of one scene"
            )
            return state, 0.0, ends, False, {}

        # A step's random numbers are addressed by scene and seed, so these identify the
        # disturbance.
        return SceneInstance(state, {}, hashed(state), hashed(scene, seed), step, lambda: state)


def _returned(name: str, function: Callable[..., Any], *arguments: Any) -> Any:
    state = function(*arguments)
    if state is None:
        raise mistake_in(function, f"`{name}` returned nothing: it must return the state")
    return state
