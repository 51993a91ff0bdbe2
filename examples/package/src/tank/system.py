"""A leaking tank: the valve and the estimate of the leak read one level sensor."""

from faultpath.system import ComposedSystem, FunctionPlant, writes

DT_S, TARGET_M = 0.1, 1.5


@writes("leak", past="inflow")
def observer(level, inflow, share, memory):
    """Estimate the leak: what flowed in and did not raise the level."""
    before, leak = (level, 0 * level) if memory is None else memory
    leak = leak + share * (inflow - (level - before) / DT_S - leak)
    return leak, (level, leak)


@writes("inflow", before=0.0)
def valve(level, leak):
    return (2 * (TARGET_M - level) + leak).clip(0, 3)


def start(rng):
    return {"level": rng.uniform(0.5, 2.5), "leak": rng.uniform(0.1, 1.0)}


def step(state, inflow, rng):
    leak = state["leak"] + rng.normal(scale=0.1)
    return state | {"level": max(0.0, state["level"] + (inflow - leak) * DT_S)}


def create() -> ComposedSystem:
    plant = FunctionPlant(
        start,
        step,
        observes={"level": "level"},
        action="inflow",
        steps=25,
        dt_s=DT_S,
        succeeded=lambda episode: abs(episode["level"][-1] - TARGET_M) < 0.1,
    )
    variants = {
        "slow": [observer.given(share=0.05), valve],
        "quick": [observer.given(share=0.5), valve],
    }
    units = {"level": "m", "leak": "m/s", "inflow": "m/s"}
    return ComposedSystem("tank", plant, variants, units)
