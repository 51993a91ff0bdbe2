"""MuJoCo: its integrator under our vehicle, and its ray caster on our scenes."""

from collections.abc import Iterable, Sequence

import mujoco
import numpy as np
import torch

from benchmarks import physics
from benchmarks.measure import Side
from faultpath.quadrotor import so3
from faultpath.quadrotor.perception.camera import HEIGHT, RANGE_M, WIDTH
from faultpath.quadrotor.perception.camera import rays as camera_rays
from faultpath.quadrotor.plant.mujoco_plant import MujocoPlant, build_model
from faultpath.quadrotor.scenes.scene import Scene
from faultpath.quadrotor.vehicle import GRAVITY_MPS2, STEPS_PER_CONTROL


def steps(control: str = "none") -> Side:
    """A control interval of every vehicle; the unit is a step of 2 ms.

    `control` `none` holds the motors' commands over the interval, so that one call of MuJoCo makes
    all steps of a vehicle: body, motors' lag and drag, but no rate loop. `python` is the plant of
    audits, with rate loop and mixer at every step.
    """
    if control == "python":
        return physics.full_plant(MujocoPlant)
    chosen = physics.vehicles()
    models = [build_model(vehicle) for vehicle in chosen]
    for model in models:
        model.opt.integrator = mujoco.mjtIntegrator.mjINT_EULER  # a quarter of the work
    datas = [mujoco.MjData(model) for model in models]
    hover = [v.mass_kg * GRAVITY_MPS2 / v.thrust_scale / 4 for v in chosen]

    def prepare() -> None:
        """Go back to the start: a vehicle without control would tumble off."""
        for model, data, thrust in zip(models, datas, hover, strict=True):
            mujoco.mj_resetData(model, data)
            data.act[:] = thrust

    def work() -> None:
        for model, data, thrust in zip(models, datas, hover, strict=True):
            data.ctrl[:4] = thrust
            mujoco.mj_step(model, data, STEPS_PER_CONTROL)

    return Side(work, physics.VEHICLES * STEPS_PER_CONTROL, prepare=prepare)


def rays() -> Side:
    """One call of `mj_multiRay` an image, over the boxes and pillars that our renderer draws."""
    chosen = physics.scenes()
    models = [_model(scene) for scene in chosen]
    datas = [mujoco.MjData(model) for model in models]
    for model, data in zip(models, datas, strict=True):
        mujoco.mj_forward(model, data)
    poses = physics.camera_poses(chosen)
    local = camera_rays().flatten(1)
    length = local.norm(dim=0).numpy()
    count, reach = len(length), RANGE_M * float(length.max())
    eyes = [np.ascontiguousarray(eye) for eye in poses.position.T.numpy()]
    world = [so3.rotate(turn[..., None], local) for turn in poses.rotation.unbind(-1)]
    directions = [(ray.T.numpy() / length[:, None]).ravel() for ray in world]
    geom = np.zeros((len(chosen), count), np.int32)
    distance = np.zeros((len(chosen), count))

    def work() -> None:
        for i, (model, data) in enumerate(zip(models, datas, strict=True)):
            mujoco.mj_multiRay(
                model, data, eyes[i], directions[i], None, True, -1,
                geom[i], distance[i], None, count, reach,
            )  # fmt: skip

    def answer() -> Sequence[float]:
        found = np.where(geom >= 0, distance / length, RANGE_M).clip(0, RANGE_M)
        return physics.depths(torch.from_numpy(found).view(-1, HEIGHT, WIDTH))

    return Side(work, len(chosen), answer)


def _model(scene: Scene) -> mujoco.MjModel:
    geoms = [
        _geom("box", box.centre_m, box.half_extents_m, f' euler="0 0 {box.yaw_rad}"')
        for box in scene.boxes
    ]
    for pillar in scene.cylinders:
        middle, half = (pillar.low_m + pillar.high_m) / 2, (pillar.high_m - pillar.low_m) / 2
        geoms.append(_geom("cylinder", (*pillar.centre_m, middle), (pillar.radius_m, half)))
    low, high = np.array(scene.bounds.low_m), np.array(scene.bounds.high_m)
    for axis in range(3):
        for at, side in ((low, -1), (high, 1)):
            centre, size = (low + high) / 2, (high - low) / 2 + 1
            centre[axis], size[axis] = at[axis] + side * 0.5, 0.5
            geoms.append(_geom("box", centre.tolist(), size.tolist()))
    return mujoco.MjModel.from_xml_string(
        f'<mujoco><compiler angle="radian"/><worldbody>{"".join(geoms)}</worldbody></mujoco>'
    )


def _geom(kind: str, centre: Iterable[float], size: Iterable[float], turned: str = "") -> str:
    place, extent = (" ".join(map(repr, values)) for values in (centre, size))
    return f'<geom type="{kind}" pos="{place}" size="{extent}"{turned}/>'
