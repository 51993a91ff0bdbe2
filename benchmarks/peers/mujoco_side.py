"""MuJoCo: its integrator under our vehicle, and its ray caster on our scenes."""

from collections.abc import Sequence

import mujoco
import numpy as np
import torch
from typing_extensions import override

from benchmarks import physics
from benchmarks.side import Side
from faultpath.quadrotor import so3
from faultpath.quadrotor.perception.camera import HEIGHT, RANGE_M, WIDTH, rays
from faultpath.quadrotor.plant.mujoco_plant import MujocoPlant, build_model
from faultpath.quadrotor.scenes.scene import Scene
from faultpath.quadrotor.vehicle import GRAVITY_MPS2, STEPS_PER_CONTROL


class Steps(Side):
    """A control interval of every vehicle, one after the other; the unit is a step of 2 ms.

    `control` `none` holds the motors' commands over the interval, so that one call of MuJoCo makes
    all its steps: body, motors' lag and drag, but no rate loop. `python` computes rate loop and
    mixer at every step, as the physics of a comparable flight need.
    """

    def __init__(self, control: str = "none") -> None:
        torch.set_num_threads(1)
        self.amount = physics.VEHICLES * STEPS_PER_CONTROL
        chosen = physics.vehicles(physics.VEHICLES)
        self._models = [build_model(vehicle) for vehicle in chosen]
        for model in self._models:
            model.opt.integrator = mujoco.mjtIntegrator.mjINT_EULER  # a quarter of the work
        self._datas = [mujoco.MjData(model) for model in self._models]
        self._hover = [v.mass_kg * GRAVITY_MPS2 / v.thrust_scale for v in chosen]
        self._flown = physics.FullPlant(build=MujocoPlant) if control == "python" else None

    def prepare(self) -> None:
        """Go back to the start: a vehicle without control would tumble off."""
        for model, data, hover in zip(self._models, self._datas, self._hover, strict=True):
            mujoco.mj_resetData(model, data)
            data.act[:] = hover / 4

    @override
    def work(self) -> None:
        if self._flown is not None:
            self._flown.work()
            return
        for model, data, hover in zip(self._models, self._datas, self._hover, strict=True):
            data.ctrl[:4] = hover / 4
            mujoco.mj_step(model, data, STEPS_PER_CONTROL)


class Rays(Side):
    """One call of `mj_multiRay` an image, over the boxes and pillars that our renderer draws."""

    def __init__(self) -> None:
        torch.set_num_threads(1)
        chosen = physics.scenes()
        self.amount = len(chosen)
        self._models = [_model(scene) for scene in chosen]
        self._datas = [mujoco.MjData(model) for model in self._models]
        for model, data in zip(self._models, self._datas, strict=True):
            mujoco.mj_forward(model, data)
        poses = physics.camera_poses(chosen)
        local = rays().flatten(1)
        self._length = local.norm(dim=0).numpy()
        self._eyes = [np.ascontiguousarray(eye) for eye in poses.position.T.numpy()]
        world = [so3.rotate(turn[..., None], local) for turn in poses.rotation.unbind(-1)]
        self._rays = [(ray.T.numpy() / self._length[:, None]).ravel() for ray in world]
        count = len(self._length)
        self._geom = np.zeros((len(chosen), count), np.int32)
        self._distance = np.zeros((len(chosen), count))

    @override
    def work(self) -> None:
        count, reach = len(self._length), RANGE_M * float(self._length.max())
        for i, model in enumerate(self._models):
            mujoco.mj_multiRay(
                model, self._datas[i], self._eyes[i], self._rays[i], None, True, -1,
                self._geom[i], self._distance[i], None, count, reach,
            )  # fmt: skip

    @override
    def answer(self) -> Sequence[float]:
        found = np.where(self._geom >= 0, self._distance / self._length, RANGE_M).clip(0, RANGE_M)
        return physics.depths(torch.from_numpy(found).view(-1, HEIGHT, WIDTH))


def _model(scene: Scene) -> mujoco.MjModel:
    """Return a scene's solids and its six walls as geoms of the world."""

    def numbers(values: Sequence[float]) -> str:
        return " ".join(map(repr, values))

    geoms = [
        f'<geom type="box" pos="{numbers(box.centre_m)}" size="{numbers(box.half_extents_m)}" '
        f'euler="0 0 {box.yaw_rad}"/>'
        for box in scene.boxes
    ]
    for pillar in scene.cylinders:
        middle, half = (pillar.low_m + pillar.high_m) / 2, (pillar.high_m - pillar.low_m) / 2
        geoms.append(
            f'<geom type="cylinder" pos="{numbers((*pillar.centre_m, middle))}" '
            f'size="{numbers((pillar.radius_m, half))}"/>'
        )
    low, high = np.array(scene.bounds.low_m), np.array(scene.bounds.high_m)
    for axis in range(3):
        for at, side in ((low, -1), (high, 1)):
            centre, size = (low + high) / 2, (high - low) / 2 + 1
            centre[axis], size[axis] = at[axis] + side * 0.5, 0.5
            geoms.append(
                f'<geom type="box" pos="{numbers(centre.tolist())}" '
                f'size="{numbers(size.tolist())}"/>'
            )
    return mujoco.MjModel.from_xml_string(
        f'<mujoco><compiler angle="radian"/><worldbody>{"".join(geoms)}</worldbody></mujoco>'
    )
