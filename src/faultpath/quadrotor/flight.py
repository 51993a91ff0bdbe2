"""One closed-loop flight of a block of scenes, step by step."""

from collections.abc import Iterator, Sequence
from dataclasses import replace

from torch import Tensor

from faultpath.quadrotor.device import at_hand
from faultpath.quadrotor.navigator import Navigator
from faultpath.quadrotor.perception import DepthRenderer, mounted
from faultpath.quadrotor.sensors import Sensors
from faultpath.quadrotor.world import CONTROL_STEPS, World
from faultpath.taps import Taps

LOOK_EVERY = 10
"""Control steps between two looks at whether any trial still runs, where a look waits for the
device: half a second of flight is the most that is computed in vain."""


class Flight:
    """World, camera and navigator of a block; without a camera nothing reads depth."""

    def __init__(
        self, world: World, navigator: Navigator, camera: DepthRenderer | None, taps: Taps
    ) -> None:
        self.world = world
        self.navigator = navigator
        self._camera = camera
        self._taps = taps

    def commands(self) -> Iterator[Tensor]:
        """Yield each command `[4, L]` at the moment from which it acts, until all trials ended."""
        world = self.world
        for step in range(CONTROL_STEPS):
            running = world.progress.running[: world.count]
            planned = _planned(running, step)
            if not planned:
                return
            self._taps.set_active(running)
            sensors = Sensors.read(world, self._depth())
            command = self.navigator.act(sensors, step, planned)
            yield command
            world.advance(command)

    def _depth(self) -> Tensor | None:
        if self._camera is None:
            return None
        state = self.world.state
        return self._camera.render(replace(state, rotation=mounted(state.rotation)))


def _planned(running: Tensor, step: int) -> Sequence[int]:
    """Return the scenes to plan for, none once all trials have ended; `running` is `[B]`.

    Only the device knows which trials run there. All scenes are planned, and a scene's plan no
    longer counts once its trial has ended.
    """
    if at_hand(running.device):
        return running.nonzero()[:, 0].tolist()
    if (step + 1) % LOOK_EVERY == 0 and not running.any():
        return ()
    return range(len(running))
