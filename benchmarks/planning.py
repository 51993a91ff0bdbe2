"""Replans and rollouts of WM-A against other planners and against the machine's own rate."""

from benchmarks.comparison import Comparison, Outcome, Writer, at_least
from benchmarks.measure import Work, interleaved
from benchmarks.planner import flops_per_replan

PORTABLE = {"FAULTPATH_KERNELS": "portable"}
OURS = "benchmarks.planner"
PEERS = "benchmarks.peers"
UNIT = "replans/s"
GFLOPS = "GFLOP/s"


def rollouts() -> Outcome:
    """Compare the rollout alone with JAX and with what the machine multiplies."""
    scans = {f"JAX scan, {words}": layout for words, layout in (("[F, K]", "FK"), ("[K, F]", "KF"))}
    works = {
        "torch.mm, 1024": Work(f"{OURS}:MatrixProduct"),
        "torch.mm, a layer": Work(
            f"{OURS}:MatrixProduct", {"rows": 64, "inner": 64, "columns": 512}
        ),
        "fused": Work(f"{OURS}:Rollout"),
        "portable": Work(f"{OURS}:Rollout", environment=PORTABLE),
        **{name: Work(f"{PEERS}.jax_scan:Scan", {"layout": at}) for name, at in scans.items()},
    }
    rates = interleaved(works, same=dict.fromkeys(("fused", *scans), "portable"))
    flops = 1e-9 * flops_per_replan()
    for name in ("fused", "portable"):
        rates = rates.also(f"{name}, as multiplication", name, flops)
    writer = Writer("rollout", rates)
    return Outcome(
        [
            *(
                writer.versus(f"Fused rollout, {name}", "fused", name, UNIT, at_least(1.4))
                for name in scans
            ),
            writer.versus("Portable rollout, JAX scan", "portable", "JAX scan, [F, K]", UNIT),
            writer.versus("Fused rollout, portable", "fused", "portable", UNIT),
            writer.versus(
                "Fused rollout, share of torch.mm",
                "fused, as multiplication",
                "torch.mm, 1024",
                GFLOPS,
                at_least(0.75),
            ),
            writer.versus(
                "Portable rollout, share of torch.mm",
                "portable, as multiplication",
                "torch.mm, 1024",
                GFLOPS,
            ),
            writer.versus(
                "Fused rollout, share of torch.mm on a layer",
                "fused, as multiplication",
                "torch.mm, a layer",
                GFLOPS,
            ),
        ]
    )


def replans() -> Outcome:
    """Compare whole replans, of one scene and of sixteen."""
    peer = f"{PEERS}.pytorch_mppi_side:Command"
    works = {
        "fused": Work(f"{OURS}:Replan"),
        "portable": Work(f"{OURS}:Replan", environment=PORTABLE),
        "portable, 16 scenes": Work(f"{OURS}:Replan", {"scenes": 16}, PORTABLE),
        "fused, 16 scenes": Work(f"{OURS}:Replan", {"scenes": 16}),
        "pytorch_mppi": Work(peer),
        "pytorch_mppi, 16 scenes": Work(peer, {"scenes": 16}),
        "pytorch_mppi, our layout": Work(peer, {"layout": "columns"}, PORTABLE),
        "torchrl": Work(f"{PEERS}.torchrl_side:Planning"),
    }
    rates = interleaved(works, same=dict.fromkeys(("fused", "pytorch_mppi", "torchrl"), "portable"))
    writer = Writer("replan", rates)
    return Outcome(
        [
            writer.versus(
                "Fused replan, pytorch_mppi", "fused", "pytorch_mppi", UNIT, at_least(5.0)
            ),
            writer.versus(
                "Portable replan of 16 scenes, pytorch_mppi",
                "portable, 16 scenes",
                "pytorch_mppi, 16 scenes",
                UNIT,
                at_least(1.7),
            ),
            writer.versus(
                "Fused replan of 16 scenes, pytorch_mppi",
                "fused, 16 scenes",
                "pytorch_mppi, 16 scenes",
                UNIT,
            ),
            writer.versus("Portable replan, pytorch_mppi", "portable", "pytorch_mppi", UNIT),
            writer.versus(
                "Fused replan, pytorch_mppi with our layout",
                "fused",
                "pytorch_mppi, our layout",
                UNIT,
            ),
            writer.versus("Fused replan, torchrl", "fused", "torchrl", UNIT),
        ]
    )


def compiled() -> Outcome:
    """Compare whole replans with pytorch_mppi compiled, which takes minutes to start."""
    peer = "pytorch_mppi, torch.compile"
    works = {
        "fused": Work(f"{OURS}:Replan"),
        peer: Work(f"{PEERS}.pytorch_mppi_side:Command", {"compiled": True}),
    }
    writer = Writer("compiled", interleaved(works, same={peer: "fused"}))
    return Outcome([writer.versus("Fused replan, pytorch_mppi compiled", "fused", peer, UNIT)])


COMPARISONS = (
    Comparison("rollout", rollouts),
    Comparison("replan", replans),
    Comparison("compiled", compiled),
)
