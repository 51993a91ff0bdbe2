"""MuJoCo: its integrator under our vehicle, and its ray caster on our scenes."""

from collections.abc import Iterable

import mujoco
import numpy as np
from faultpath_quadrotor import so3
from faultpath_quadrotor.perception.camera import RANGE_M
from faultpath_quadrotor.perception.camera import rays as camera_rays
from faultpath_quadrotor.scenes.scene import Scene

from benchmarks import physics
from benchmarks.side import Side, check_same
from examples.mujoco_plant import MujocoPlant


def steps() -> Side:
    """A control interval of every vehicle with rate loop and mixer, as audits can fly it."""
    return physics.plant(MujocoPlant)


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

    work()
    depths = np.where(geom >= 0, distance / length, RANGE_M).clip(0, RANGE_M)
    # The mean of each image: a pixel on an edge may fall on either side.
    check_same(depths.mean(1), physics.images().flatten(1).double().mean(1), 0.02)
    return Side(work, len(chosen))


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
