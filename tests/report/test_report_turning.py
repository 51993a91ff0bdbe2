"""The smallest size that turns the verdict was flown, and is decided for all sizes at once."""

from dataclasses import replace

import pytest

from faultpath.report.comparison.page import page
from faultpath.report.comparison.runs import Compared, titles
from faultpath.report.comparison.sweep import together
from faultpath.report.comparison.turning import turning
from faultpath.report.inputs import ReportInput

SIZES = (-0.2, -0.1, 0.1, 0.2, 0.4)
Decided = tuple[int, float, float]
"""Sign, adjusted p-value and estimate."""
WON, LOST, OPEN = (1, 1e-5, 20.0), (-1, 1e-5, -20.0), (0, 1.0, -2.0)


def sized(source: ReportInput, fault: str, correct: Decided, shared: Decided) -> Compared:
    told = []
    for effect in source.record.effects:
        sign, p, value = {"correct": correct, "shared": shared}.get(effect.path, OPEN)
        success = effect.success.model_copy(update={"value": value})
        changed = {"sign": sign, "p_value": p, "adjusted_p_value": p, "success": success}
        told.append(effect.model_copy(update=changed))
    question = source.record.question.model_copy(update={"fault": fault})
    record = source.record.model_copy(update={"effects": tuple(told), "question": question})
    return Compared(1, f"runs/{fault}", record, source.provenance)


def shown(source: ReportInput, correct: Decided, *shared: Decided, fault: str = "calibration"):
    """The entries of the shared path above and below the size that is no fault."""
    runs = [
        replace(sized(source, f"{fault}={size}", correct, each), number=number)
        for number, (size, each) in enumerate(zip(SIZES, shared, strict=True), 1)
    ]
    table = turning(together(runs))
    assert table is not None
    found = {each.label: tuple(e.text for e in each.entries) for each in table.lines}
    title = titles(runs)["shared"]
    return found[f"{title}, above 0"], found[f"{title}, below 0"]


def test_a_turn_lies_between_the_sizes_that_are_decided(one_seed: ReportInput) -> None:
    asked = one_seed.record.question
    above, below = shown(one_seed, WON, LOST, WON, WON, OPEN, LOST)
    assert above == (f"{asked.repair}, 0.1", "0.2", f"{asked.baseline}, 0.4")
    assert below == (f"{asked.repair}, −0.1", "−0.2", f"{asked.baseline}, −0.2")


@pytest.mark.parametrize("tie", [(0, 1.0, 0.0), (0, 1.0, 3.0), (1, 0.02, 20.0)])
def test_what_is_not_decided_for_all_sizes_at_once_is_a_dash(
    one_seed: ReportInput, tie: Decided
) -> None:
    for row in shown(one_seed, tie, *[tie] * len(SIZES)):
        assert row == ("–", "–", "–")


def test_where_no_fault_decides_nothing_only_what_is_decided_is_named(
    one_seed: ReportInput,
) -> None:
    above, below = shown(one_seed, OPEN, OPEN, OPEN, OPEN, LOST, LOST)
    assert above == ("–", "–", f"{one_seed.record.question.baseline}, 0.2")
    assert below == ("–", "–", "–")


def test_there_is_no_table_without_sizes_of_one_fault_and_a_size_that_is_none(
    one_seed: ReportInput,
) -> None:
    runs = [sized(one_seed, f"mass:replace={size}", WON, WON) for size in SIZES]
    assert turning(runs) is None
    assert turning(runs[:1]) is None
    few = [sized(one_seed, f"calibration={size}", WON, LOST) for size in SIZES]
    assert turning(few[:2]) is None
    title = "Smallest size that turns the verdict"
    several = tuple(replace(run, number=i) for i, run in enumerate(few, 1))
    assert title in page(several)
    assert title not in page(several[:2])
