"""All that is measured: which sides run against which, and what is asked of them."""

from collections.abc import Mapping

from benchmarks import ablation, commands, loop
from benchmarks.comparison import Comparison, Contest, Row
from benchmarks.measure import Work, portable
from benchmarks.planning import gflop_per_replan
from benchmarks.results import at_least, at_most

ROLLOUT = "benchmarks.planning:rollout"
REPLAN = "benchmarks.planning:replan"
PRODUCT = "benchmarks.planning:matrix_product"
PLANT = "benchmarks.physics:full_plant"
BOOTSTRAP = "benchmarks.bootstrap"
PEERS = "benchmarks.peers"

FK, KF = "JAX scan, [F, K]", "JAX scan, [K, F]"
SQUARE, LAYER = "torch.mm, 1024", "torch.mm, a layer"
MPPI, MANY = "pytorch_mppi", "pytorch_mppi, 16 scenes"
OURS, COMPILED = "pytorch_mppi, our layout", "pytorch_mppi, torch.compile"
LOOPED, FREE = "MuJoCo, rate loop in Python", "MuJoCo, no rate loop"
GFLOPS = {"unit": "GFLOP/s", "scale": gflop_per_replan}

CONTESTS: Mapping[str, Contest] = {
    "rollout": Contest(
        unit="replans/s",
        sides={
            SQUARE: Work(PRODUCT),
            LAYER: Work(PRODUCT, {"rows": 64, "inner": 64, "columns": 512}),
            "fused": Work(ROLLOUT),
            "portable": portable(ROLLOUT),
            FK: Work(f"{PEERS}.jax_scan:scan", {"layout": "FK"}),
            KF: Work(f"{PEERS}.jax_scan:scan", {"layout": "KF"}),
        },
        same=dict.fromkeys(("fused", FK, KF), "portable"),
        rows=(
            Row("Fused rollout, JAX scan, [F, K]", "fused", FK, at_least(1.4)),
            Row("Fused rollout, JAX scan, [K, F]", "fused", KF, at_least(1.4)),
            Row("Portable rollout, JAX scan", "portable", FK),
            Row("Fused rollout, portable", "fused", "portable"),
            Row("Fused rollout, share of torch.mm", "fused", SQUARE, at_least(0.75), **GFLOPS),
            Row("Portable rollout, share of torch.mm", "portable", SQUARE, **GFLOPS),
            Row("Fused rollout, share of torch.mm on a layer", "fused", LAYER, **GFLOPS),
        ),
    ),
    "replan": Contest(
        unit="replans/s",
        sides={
            "fused": Work(REPLAN),
            "portable": portable(REPLAN),
            "portable, 16": portable(REPLAN, scenes=16),
            "fused, 16": Work(REPLAN, {"scenes": 16}),
            MPPI: Work(f"{PEERS}.pytorch_mppi_side:command"),
            MANY: Work(f"{PEERS}.pytorch_mppi_side:command", {"scenes": 16}),
            OURS: portable(f"{PEERS}.pytorch_mppi_side:command", layout="columns"),
            "torchrl": Work(f"{PEERS}.torchrl_side:planning"),
        },
        same=dict.fromkeys(("fused", MPPI, "torchrl"), "portable"),
        rows=(
            Row("Fused replan, pytorch_mppi", "fused", MPPI, at_least(5.0)),
            Row("Portable replan of 16 scenes, pytorch_mppi", "portable, 16", MANY, at_least(1.7)),
            Row("Fused replan of 16 scenes, pytorch_mppi", "fused, 16", MANY),
            Row("Portable replan, pytorch_mppi", "portable", MPPI),
            Row("Fused replan, pytorch_mppi with our layout", "fused", OURS),
            Row("Fused replan, torchrl", "fused", "torchrl"),
        ),
    ),
    "compiled": Contest(  # apart: it takes minutes to start
        unit="replans/s",
        sides={
            "fused": Work(REPLAN),
            COMPILED: Work(f"{PEERS}.pytorch_mppi_side:command", {"compiled": True}),
        },
        same={COMPILED: "fused"},
        rows=(Row("Fused replan, pytorch_mppi compiled", "fused", COMPILED),),
    ),
    "plant": Contest(
        unit="vehicle-steps/s",
        sides={
            "faultpath": Work(PLANT),
            "portable": portable(PLANT),
            "RotorPy": Work(f"{PEERS}.rotorpy_side:hummingbirds"),
            LOOPED: Work(f"{PEERS}.mujoco_side:steps", {"control": "python"}),
            FREE: Work(f"{PEERS}.mujoco_side:steps"),
        },
        same={"faultpath": "portable"},
        tolerance=1e-9,
        rows=(
            Row("Full plant, RotorPy", "faultpath", "RotorPy", at_least(150_000, "ours")),
            Row("Full plant, MuJoCo, rate loop in Python", "faultpath", LOOPED),
            Row("Full plant, MuJoCo, no rate loop", "faultpath", FREE),
            Row("Portable plant, RotorPy", "portable", "RotorPy"),
        ),
    ),
    "depth": Contest(
        unit="images/s",
        sides={
            "faultpath": Work("benchmarks.physics:rendering"),
            "mj_multiRay": Work(f"{PEERS}.mujoco_side:rays"),
        },
        same={"mj_multiRay": "faultpath"},
        tolerance=0.02,
        rows=(Row("Depth image 64 x 36", "faultpath", "mj_multiRay", at_least(1.0)),),
    ),
    "bootstrap": Contest(
        unit="ms",
        sides={
            "faultpath": Work(f"{BOOTSTRAP}:ours"),
            "drawn": Work(f"{BOOTSTRAP}:ours", {"drawn": True}),
            "scipy.stats.bootstrap": Work(f"{BOOTSTRAP}:scipy"),
        },
        same={"scipy.stats.bootstrap": "faultpath"},
        tolerance=1.0,
        rows=tuple(
            Row(name, ours, "scipy.stats.bootstrap", at_most(20.0, "ours"))
            for name, ours in (
                ("Bootstrap with its draw", "faultpath"),
                ("Bootstrap on drawn resamples", "drawn"),
            )
        ),
    ),
}


def _contest(name: str, edition: int = 1, changed: str = "") -> Comparison:
    return Comparison(name, {name: CONTESTS[name]}, edition, changed)


COMPARISONS: Mapping[str, Comparison] = {
    each.name: each
    for each in (
        _contest("rollout"),
        _contest("replan"),
        _contest("compiled"),
        Comparison(
            "closed-loop",
            loop.CLOSED_LOOP,
            edition=3,
            changed="candidates, weights and mean run in torch",
        ),
        Comparison(
            "kernels",
            ablation.CASES,
            edition=2,
            changed="candidates, weights and mean have no kernel any more",
        ),
        Comparison("latency", loop.ONE_VEHICLE),
        _contest(
            "plant",
            edition=2,
            changed="MuJoCo with a rate loop has become the batched plant that audits can fly, "
            "many times as fast as its row shows",
        ),
        _contest("depth"),
        _contest("bootstrap"),
        Comparison("scaling", loop.GROWTH),
        Comparison("workers", commands.WORKERS),
        Comparison("start-up", commands.START_UP),
    )
}
"""By name, in the order of the page."""
