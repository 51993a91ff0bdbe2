"""One closed-loop flight of a block of scenes, step by step."""

from collections.abc import Iterator
from dataclasses import replace

from torch import Tensor

from faultpath.quadrotor.navigator import Navigator
from faultpath.quadrotor.perception import DepthRenderer, mounted
from faultpath.quadrotor.sensors import Sensors
from faultpath.quadrotor.world import CONTROL_STEPS, World
from faultpath.taps import Taps


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
            if not running.any():
                return
            self._taps.set_active(running.numpy())
            sensors = Sensors.read(world, self._depth())
            command = self.navigator.act(sensors, step, running.nonzero()[:, 0].tolist())
            yield command
            world.advance(command)

    def _depth(self) -> Tensor | None:
        if self._camera is None:
            return None
        state = self.world.state
        return self._camera.render(replace(state, rotation=mounted(state.rotation)))
