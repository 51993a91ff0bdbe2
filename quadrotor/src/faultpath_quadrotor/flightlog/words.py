"""Sentences and a table of what sharing a calibration error did on a recorded flight."""

from math import exp

from faultpath.plugin.results import MISSING, Estimate, Table, counted, interval, line, plain
from faultpath_quadrotor.flightlog.compensation import (
    Combination,
    Compensation,
    SharedAgainstIsolated,
)

CAVEAT = (
    "This is about the acceleration one control interval ahead on this flight. It says where "
    "errors cancel, not what a closed loop would have done."
)


def sentences(compensation: Compensation) -> tuple[str, ...]:
    """Return a sentence for each size of the error, or why there is too little data."""
    if compensation.too_short:
        return (compensation.too_short,)
    return tuple(map(_sentence, compensation.shared))


def _sentence(comparison: SharedAgainstIsolated) -> str:
    high, low = ("high", "low") if comparison.error > 0 else ("low", "high")
    effect = "the data do not show whether sharing the error compensates for it"
    if comparison.decided != "not decided":
        helps = comparison.decided == "less"
        effect = "sharing compensates" if helps else "sharing makes it worse"
        ratio = f"{exp(comparison.log_ratio.value):.2f} times {_range(comparison.log_ratio)}"
        effect += f": the error is {ratio.rstrip()} that with the observer alone wrong"
    size = f"{abs(100 * comparison.error):g} %"
    return f"With mass {size} too {high} and thrust {size} too {low}, {effect}."


def _range(log: Estimate) -> str:
    if log.low is None or log.high is None:
        return ""
    return f"[{exp(log.low):.2f}, {exp(log.high):.2f}]"


def _label(combination: Combination) -> str:
    if combination.observer and combination.predictor:
        return f"both {_percent(combination.observer)}"
    if combination.observer:
        return f"observer {_percent(combination.observer)}"
    return f"predictor {_percent(combination.predictor)}" if combination.predictor else "correct"


def _percent(error: float) -> str:
    return f"{100 * error:+g} %".replace("-", "−")


def table(compensation: Compensation) -> Table:
    """Return the error of every combination, with intervals."""
    drag = "without a model of drag" if compensation.drag_kgps is None else "with linear drag"
    return Table(
        name="compensation",
        title="Error of the combined acceleration",
        corner="Calibration error",
        columns=("Median, m/s²", "95 % interval", "of correct", "95 % interval of it"),
        lines=tuple(
            line(
                _label(combination),
                plain(combination.error_mps2.value, 2),
                interval(combination.error_mps2, 2),
                f"{exp(ratio.value):.2f}" if (ratio := combination.log_ratio) else MISSING,
                _range(ratio) if ratio else "",
            )
            for combination in compensation.combinations
        ),
        notes=(
            f"{compensation.flown_s:.0f} s of flight, "
            f"{counted(compensation.intervals, 'control interval')} in "
            f"{counted(compensation.blocks, 'block')} of {plain(compensation.block_s, 1)} s, "
            f"{counted(compensation.gaps, 'gap')}; mass {compensation.mass_kg:g} kg, {drag}. "
            "Intervals resample blocks.",
        ),
    )
