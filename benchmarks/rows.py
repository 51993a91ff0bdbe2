"""All rows of the benchmarks: which sides are compared, and the targets."""

from collections.abc import Mapping
from dataclasses import dataclass

from faultpath_quadrotor.native import library

from benchmarks.results import LOOP_STEPS, VEHICLE_STEPS, Target

_XLA = "--xla_cpu_multi_thread_eigen=false intra_op_parallelism_threads=1"
_PORTABLE = {library.VARIABLE: library.PORTABLE}
_AVX2 = {
    library.VARIABLE: "avx2",
    "ATEN_CPU_CAPABILITY": "avx2",
    "ONEDNN_MAX_CPU_ISA": "AVX2",
    "MKL_ENABLE_INSTRUCTIONS": "AVX2",
}
"""Keeps ours and torch to vectors of half the width."""

SIDES: Mapping[str, tuple[str, Mapping[str, str]]] = {
    "fused rollout": ("benchmarks.planning:rollout", {}),
    "portable": ("benchmarks.planning:rollout", _PORTABLE),
    "torch.mm": ("benchmarks.planning:network_product", {}),
    "fused replan": ("benchmarks.planning:replan", {}),
    "fused replan, AVX2": ("benchmarks.planning:replan", _AVX2),
    "portable replan": ("benchmarks.planning:replan", _PORTABLE),
    "pytorch_mppi": ("benchmarks.peers.pytorch_mppi_side:command", {}),
    "pytorch_mppi, AVX2": ("benchmarks.peers.pytorch_mppi_side:command", _AVX2),
    "torchrl": ("benchmarks.peers.torchrl_side:planning_step", {}),
    "jax-mppi": ("benchmarks.peers.jax_mppi_side:command", {"XLA_FLAGS": _XLA}),
    "one vehicle": ("benchmarks.planning:one_vehicle", {}),
    "plant": ("benchmarks.physics:plant", {}),
    "portable plant": ("benchmarks.physics:plant", _PORTABLE),
    "RotorPy": ("benchmarks.peers.rotorpy_side:hummingbirds", {}),
    "MuJoCo": ("benchmarks.peers.mujoco_side:steps", {}),
    "rendering": ("benchmarks.physics:rendering", {}),
    "mj_multiRay": ("benchmarks.peers.mujoco_side:rays", {}),
    "bootstrap": ("benchmarks.physics:bootstrap", {}),
    "scipy.stats.bootstrap": ("benchmarks.peers.scipy_side:percentile", {}),
    "100,000 scenes": ("benchmarks.many_scenes:many", {}),
    "10,000 scenes": ("benchmarks.many_scenes:few", {}),
    "one scene": ("benchmarks.cost:one_scene", {}),
    "bare loop, one scene": ("benchmarks.cost:bare_scene", {}),
    "audit": ("benchmarks.cost:arm_audit", {}),
    "bare loop": ("benchmarks.cost:bare_trials", {}),
    "judge": ("benchmarks.cost:judged", {}),
    "judge of 800,000": ("benchmarks.cost:judged_many", {}),
    "audit of 10,000 scenes": ("benchmarks.cost:many_scenes", {}),
}
"""Function that builds each side, as `module:function`, and its environment."""
ONCE = {"judge", "judge of 800,000", "audit of 10,000 scenes"}
"""Sides that take seconds: a round times them once, and their memory is told."""
ELSEWHERE = {"jax-mppi": ".venv-bench-jax/bin/python"}
"""Pythons of the sides that need one of their own; they get the problem as a file."""


@dataclass(frozen=True)
class Row:
    """Two sides, or ours alone, and the target that was set."""

    name: str
    unit: str
    ours: str
    peer: str = ""
    target: Target | None = None


def _ratio(value: float) -> Target:
    return Target(of="ratio", sense="at least", value=value)


def _at_most(value: float) -> Target:
    return Target(of="ours", sense="at most", value=value)


ROWS = (
    Row("Fused rollout, portable", "replans/s", "fused rollout", "portable"),
    Row("Fused rollout, torch.mm", "replans/s", "fused rollout", "torch.mm", _ratio(0.75)),
    Row("Fused replan, pytorch_mppi", "replans/s", "fused replan", "pytorch_mppi", _ratio(5.0)),
    Row("Fused replan by AVX2, the same", "replans/s", "fused replan, AVX2", "pytorch_mppi, AVX2"),
    Row("Fused replan, torchrl", "replans/s", "fused replan", "torchrl"),
    Row("Fused replan, jax-mppi", "replans/s", "fused replan", "jax-mppi"),
    Row("Portable replan, pytorch_mppi", "replans/s", "portable replan", "pytorch_mppi"),
    Row("One vehicle, depth image encoded and queried", "ms", "one vehicle", target=_at_most(5.0)),
    Row("Full plant, RotorPy", VEHICLE_STEPS, "plant", "RotorPy"),
    Row("Full plant, MuJoCo", VEHICLE_STEPS, "plant", "MuJoCo"),
    Row("Portable plant, RotorPy", VEHICLE_STEPS, "portable plant", "RotorPy"),
    Row("Depth image 64 x 36", "images/s", "rendering", "mj_multiRay", _ratio(1.0)),
    Row("Bootstrap with its draw", "ms", "bootstrap", "scipy.stats.bootstrap", _at_most(20.0)),
    Row("Tests of 100,000 scenes", "scenes/s", "100,000 scenes", "10,000 scenes", _ratio(0.5)),
    Row("Loop, one scene at a time", LOOP_STEPS, "one scene", "bare loop, one scene"),
    Row("Audit of 20 scenes, with its report", "trials/s", "audit", "bare loop"),
    Row("judge of 80,000 trials, with its report", "s", "judge", target=_at_most(4.0)),
    Row("judge of 800,000 trials, with its report", "s", "judge of 800,000", target=_at_most(25.0)),
    Row("Audit of 10,000 scenes, with its report", "s", "audit of 10,000 scenes"),
)
