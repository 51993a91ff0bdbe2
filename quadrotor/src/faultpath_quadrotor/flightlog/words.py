"""What a recorded flight shows of compensation, as sentences and a table."""

from math import exp

from faultpath.decisions.sentences.wording import counted, interval, plain
from faultpath.decisions.tables import MISSING, Table, line
from faultpath.statistics.estimate import Estimate
from faultpath_quadrotor.flightlog.compensation import Combination, Compensation

CAVEAT = (
    "This is about the acceleration one control interval ahead on this flight. It says where "
    "errors cancel, not what a closed loop would have done."
)


def sentences(found: Compensation) -> tuple[str, ...]:
    """Return what is decided, a sentence for each size of the error, and what is not."""
    if found.too_short:
        return (found.too_short,)
    told: list[str] = []
    for each in found.shared:
        high, low = ("high", "low") if each.error > 0 else ("low", "high")
        size = f"{abs(100 * each.error):g} %"
        said = "whether sharing the error compensates for it is not decided"
        if each.decided != "not decided":
            said = "sharing compensates" if each.decided == "less" else "sharing makes it worse"
            ratio = f"{exp(each.log_ratio.value):.2f} times {_range(each.log_ratio)}".rstrip()
            said += f": the error is {ratio} that with the observer alone wrong"
        told.append(f"With mass {size} too {high} and thrust {size} too {low}, {said}.")
    return tuple(told)


def _range(log: Estimate) -> str:
    if log.low is None or log.high is None:
        return ""
    return f"[{exp(log.low):.2f}, {exp(log.high):.2f}]"


def _label(each: Combination) -> str:
    errors = (("observer", each.observer), ("predictor", each.predictor))
    wrong = {module: f"{100 * error:+g} %" for module, error in errors if error}
    if len(wrong) == len(errors):
        wrong = {"both": wrong["observer"]}
    return " ".join(part for each in wrong.items() for part in each).replace("-", "−") or "correct"


def table(found: Compensation) -> Table:
    """Return the error of every combination, with intervals."""
    drag = "without a model of drag" if found.drag_kgps is None else "with linear drag"
    return Table(
        name="compensation",
        title="Error of the combined acceleration",
        corner="Calibration error",
        columns=("Median, m/s²", "95 % interval", "of correct", "95 % interval of it"),
        lines=tuple(
            line(
                _label(each),
                plain(each.error_mps2.value, 2),
                interval(each.error_mps2, 2),
                MISSING if each.log_ratio is None else f"{exp(each.log_ratio.value):.2f}",
                "" if each.log_ratio is None else _range(each.log_ratio),
            )
            for each in found.combinations
        ),
        notes=(
            f"{found.flown_s:.0f} s of flight, {counted(found.intervals, 'control interval')} in "
            f"{counted(found.blocks, 'block')} of {plain(found.block_s, 1)} s, "
            f"{counted(found.gaps, 'gap')}; mass {found.mass_kg:g} kg, {drag}. "
            "Intervals resample blocks.",
        ),
    )
