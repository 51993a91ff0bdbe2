"""What a recorded flight shows of compensation, as sentences, a table, a picture and a page."""

from math import exp

from markupsafe import Markup

from faultpath.flightlog import Combination, Compensation
from faultpath.record.wording import counted, interval, plain
from faultpath.report.frame import render
from faultpath.statistics import Estimate
from faultpath.tables import MISSING, Table, line
from faultpath.tables.html import html

CAVEAT = (
    "This is about the acceleration one control interval ahead on this flight. It says where "
    "errors cancel, not what a closed loop would have done."
)


def sentences(found: Compensation) -> tuple[str, ...]:
    """Return what is decided, a sentence for each size of the error, and what is not."""
    if found.too_short:
        return (found.too_short,)
    return tuple(_sentence(found, each.error) for each in found.shared)


def _sentence(found: Compensation, error: float) -> str:
    alone = _of(found, error, 0.0)
    both = _of(found, error, error)
    shared = next(each for each in found.shared if each.error == error)
    said = (
        f"Mass {_percent(error)}, thrust {_percent(-error)}: with the observer alone wrong, "
        f"{_against(alone)}; with observer and predictor wrong alike, {_against(both)}"
    )
    if shared.decided == "less":
        left = _times(shared.log_ratio).replace(" times", "", 1)
        return f"{said}. Sharing compensates: the error is {left} of that of the observer alone."
    if shared.decided == "more":
        more = _times(shared.log_ratio)
        return f"{said}. Sharing makes it worse: the error is {more} that of the observer alone."
    return f"{said}. Whether sharing the error compensates for it is not decided."


def _against(each: Combination) -> str:
    if each.log_ratio is None or each.decided == "not decided":
        return "no change of the acceleration error is decided"
    return f"the acceleration error is {_times(each.log_ratio)} that with correct calibration"


def _times(log: Estimate) -> str:
    return f"{exp(log.value):.2f} times {_range(log)}".rstrip()


def _range(log: Estimate) -> str:
    if log.low is None or log.high is None:
        return ""
    return f"[{exp(log.low):.2f}, {exp(log.high):.2f}]"


def _of(found: Compensation, observer: float, predictor: float) -> Combination:
    return next(
        each
        for each in found.combinations
        if (each.observer, each.predictor) == (observer, predictor)
    )


def _percent(error: float) -> str:
    return f"{abs(100 * error):g} % too {'high' if error > 0 else 'low'}"


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


def page(found: Compensation, log: str) -> str:
    """Return all of it as one page that opens without a network."""
    return render(
        "compensation.html.j2",
        ("tokens.css", "svg.css", "page.css"),
        (),
        log=log,
        sentences=sentences(found),
        caveat=CAVEAT,
        table=Markup(html(table(found))),
    )
