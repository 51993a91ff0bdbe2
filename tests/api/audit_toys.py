"""A system with three modules that only lays out variants and never runs."""

from faultpath.analyses.planning import Audit, plan_audit
from faultpath.faults import Fault, FaultText, Scale
from faultpath.interface import Channel, Interface, Provenance, Source
from faultpath.run import SystemSpec
from faultpath.run.question import AuditQuestion
from faultpath.system import Library, SceneRef, System, Variant

INTERFACE = Interface(
    name="paper",
    sources=(
        Source(name="scale_reading", unit="kg", provenance=Provenance.MEASURED),
        Source(name="thermometer", unit="K", provenance=Provenance.MEASURED),
    ),
    channels=(
        Channel(
            name="mass",
            sources=("scale_reading",),
            readers=("planner.cost", "planner.limit", "observer.model", "logger.file"),
        ),
        Channel(name="heat", sources=("thermometer",), readers=("logger.file",)),
    ),
)
READS = {
    "plain": {"planner.cost", "planner.limit"},
    "limited": {"planner.limit"},
    "observed": {"planner.cost", "planner.limit", "observer.model"},
    "deaf": set(),
    "logged": {"logger.file"},
}


def halve(size: float) -> tuple[Fault, ...]:
    scale = Scale(factor=size)
    return tuple(Fault(channel=name, intervention=scale) for name in ("mass", "heat"))


class Paper(System):
    name, control_dt_s, interface = "paper", 0.1, INTERFACE
    variants = {name: Variant(name, name, frozenset(reads)) for name, reads in READS.items()}  # noqa: RUF012
    fault_presets = {"both": halve}  # noqa: RUF012

    def library(self, name: str) -> Library:
        return Library(name, tuple(SceneRef(f"s{i}", i) for i in range(5)), f"{name}-1")

    def fingerprint(self) -> str:
        return "paper-1"

    def run(self, variant, scenes, taps, seed):
        raise AssertionError("planning runs nothing")


def planned(baseline: str, repair: str, text: str, **changes) -> Audit:
    system = Paper()
    return plan_audit(
        system,
        SystemSpec(name="paper"),
        AuditQuestion(baseline=baseline, repair=repair, fault=FaultText.read(text), **changes),
        system.library("five"),
    )
