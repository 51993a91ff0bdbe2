"""Whether a way exists, how long it is, and whether looking a short way ahead finds it."""

from dataclasses import dataclass
from functools import cached_property
from itertools import product

import numpy as np
from faultpath_quadrotor.scenes.field import Lattice, exact_on_lattice
from faultpath_quadrotor.scenes.library import CELL_M
from faultpath_quadrotor.scenes.scene import Point, Scene
from faultpath_quadrotor.vehicle import COLLISION_RADIUS_M
from numpy.typing import NDArray
from scipy.sparse import csr_array
from scipy.sparse.csgraph import dijkstra

MARGIN_M = 0.1
"""On lattice points 0.1 m apart this keeps every straight step between two of them clear of
contact, because distance is 1-Lipschitz."""

END_CLEARANCE_M = 0.45


@dataclass(frozen=True)
class FreeLattice:
    """Lattice points where the vehicle fits with its margin.

    Attributes:
        scene: The scene.
        lattice: Where the points lie.
        distance_m: Signed distance there, `[nx, ny, nz]`.
    """

    scene: Scene
    lattice: Lattice
    distance_m: NDArray[np.float64]

    @classmethod
    def of(cls, scene: Scene) -> "FreeLattice":
        """Return the lattice of a scene with its obstacles."""
        lattice = Lattice.over(scene)
        return cls(scene, lattice, exact_on_lattice(scene, lattice).numpy())

    @cached_property
    def free(self) -> NDArray[np.bool_]:
        """Where the vehicle fits."""
        return self.distance_m >= COLLISION_RADIUS_M + MARGIN_M - 1e-9

    @cached_property
    def _graph(self) -> csr_array:
        """Steps between neighbouring free points with their lengths, one direction of each."""
        number = np.full(self.free.shape, -1)
        number[self.free] = np.arange(self.free.sum())
        tails, heads, lengths = [], [], []
        for step in product((-1, 0, 1), repeat=3):
            if step <= (0, 0, 0):
                continue
            here = tuple(slice(max(0, -s), -s if s > 0 else None) for s in step)
            there = tuple(slice(max(0, s), s if s < 0 else None) for s in step)
            both = self.free[here] & self.free[there]
            tails.append(number[here][both])
            heads.append(number[there][both])
            lengths.append(np.full(both.sum(), np.linalg.norm(step) * CELL_M))
        size = int(self.free.sum())
        pair = (np.concatenate(tails), np.concatenate(heads))
        return csr_array((np.concatenate(lengths), pair), shape=(size, size))

    def _node(self, point: Point) -> int | None:
        nearest = tuple(
            int(np.abs(axis.numpy() - at).argmin())
            for axis, at in zip(self.lattice.axes, point, strict=True)
        )
        place = np.ravel_multi_index(nearest, self.free.shape)
        return int(np.count_nonzero(self.free.ravel()[:place])) if self.free[nearest] else None

    def _travel(self, node: int, limit: float = np.inf) -> NDArray[np.float64]:
        return dijkstra(self._graph, directed=False, indices=[node], limit=limit)[0]

    def path_length_m(self) -> float:
        """Return the length of the shortest way from start to goal, infinite when there is none."""
        start, goal = self._node(self.scene.start_m), self._node(self.scene.goal_m)
        if start is None or goal is None:
            return float("inf")
        return float(self._travel(start)[goal])

    def found_by_looking(self, ahead_m: float) -> bool:
        """Return whether a walk arrives that sees `ahead_m` of the ways before it.

        From where it stands, the walk goes to the point nearest to the goal (as the crow flies)
        among those that it can reach within `ahead_m`; it gives up when that brings it no nearer.
        This is a property of the geometry: no vehicle, model or planner takes part.
        """
        axes = np.meshgrid(*(axis.numpy() for axis in self.lattice.axes), indexing="ij")
        squares = ((axis - at) ** 2 for axis, at in zip(axes, self.scene.goal_m, strict=True))
        to_goal = np.sqrt(sum(squares))[self.free]
        here = self._node(self.scene.start_m)
        if here is None:
            return False
        while to_goal[here] > 0.5:
            reach = self._travel(here, ahead_m)
            there = int(np.where(np.isfinite(reach), to_goal, np.inf).argmin())
            if to_goal[there] > to_goal[here] - 0.1:
                return False
            here = there
        return True
