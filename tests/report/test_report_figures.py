"""Pictures: well-formed, escaped, and coloured only where something is decided."""

import re
from typing import Literal
from xml.etree import ElementTree

from faultpath.analyses.model import Ahead, AuditResult, ConditionBreakEven
from faultpath.analyses.pairs import PairKind, read_pairs
from faultpath.report.effects import (
    effect_rows,
    panel,
    share_panels,
    shared_axis,
)
from faultpath.report.inputs import ReportInput
from faultpath.report.pair_grid import pair_grid, pair_key
from faultpath.report.svg import Svg, covering, shortened, text_width
from faultpath.report.taps import fork_panel, forks
from faultpath.stats.estimate import BreakEven, Region


def test_an_axis_covers_any_number_that_a_record_may_hold() -> None:
    axis = covering([1.7e308, -1.7e308])
    assert 2 <= len(axis.ticks(4)) <= 9
    assert 0.0 < axis(1.7e308) < 1e9


def test_all_figures_are_xml(one_seed: ReportInput) -> None:
    record = one_seed.record
    pairs, (rows, axis) = read_pairs(one_seed.trials, record), effect_rows(record)
    drawn = [
        *(row.picture for row in rows),
        axis,
        _forest(record),
        pair_grid('"<title>"', pairs, {}, {"timeout": "<late>"}),
        pair_grid("nothing", (), {}, {}),
        *(sign for sign, _ in pair_key(pairs)),
        *(picture for picture, _ in share_panels(record)[0]),
        *map(fork_panel, forks(one_seed)),
    ]
    for picture in drawn:
        ElementTree.fromstring(picture)


def _forest(record: AuditResult, **changes: object) -> str:
    effect = record.effects[0].model_copy(update=changes)
    return panel("All", [("Correct inputs", effect)], shared_axis([effect]))


def test_only_what_is_decided_is_bold_and_filled(one_seed: ReportInput) -> None:
    for sign, look in ((1, "dot repair"), (-1, "dot baseline"), (0, "dot open")):
        drawn = _forest(one_seed.record, sign=sign)
        assert re.findall(r'class="(dot[^"]*)"', drawn) == [look]
        assert ('class="bold"' in drawn) == (sign != 0)
    assert "floor" in _forest(one_seed.record, rates=(5.0, 6.0))


def _panel(
    record: AuditResult,
    signs: tuple[Literal[-1, 1], ...],
    pieces: tuple[tuple[float, float], ...],
    *regions: Region,
    p_star: float | None = 0.5,
) -> tuple[list[str], list[str]]:
    """Return the pictures of a break-even, and the sentences in place of one."""
    kind = "whole" if pieces == ((0.0, 1.0),) else "interval" if pieces else "empty"
    result = BreakEven(
        p_star=p_star, pieces=pieces, kind=kind, regions=regions, method="", estimand=""
    )
    curve = ((0.0, -10.0, -20.0, 0.0), (1.0, 10.0, 0.0, 20.0))
    ahead = tuple(Ahead(sign=sign, where="many") for sign in signs)
    condition = ConditionBreakEven(
        condition="shared", over="frequency", result=result, curve=curve, ahead=ahead
    )
    shown = record.model_copy(update={"break_evens": (condition,)})
    panels, sentences = share_panels(shown)
    return [picture for picture, _ in panels], sentences


def test_the_curve_is_coloured_where_a_variant_is_decided(one_seed: ReportInput) -> None:
    record = one_seed.record
    regions = (Region(low=0.0, high=0.3, sign=-1), Region(low=0.7, high=1.0, sign=1))
    ((drawn,), _) = _panel(record, (1,), ((0.3, 0.7),), *regions)
    assert drawn.count('class="curve baseline"') == drawn.count('class="curve repair"') == 1
    assert drawn.count('class="star-range"') == 1
    assert "share of episodes with the fault, %" in drawn
    assert "expected difference in success, pp" in drawn
    ((silent,), _) = _panel(record, (), ((0.3, 0.7),), *regions)
    assert "curve baseline" not in silent
    assert "curve repair" not in silent
    assert "No frequency is significant." in silent
    ((both,), _) = _panel(record, (1,), ((0.0, 0.2), (0.6, 1.0)), Region(low=0.2, high=0.6, sign=1))
    assert both.count('class="star-range"') == 2


def test_a_break_even_is_drawn_only_where_there_is_one(one_seed: ReportInput) -> None:
    record, ahead = one_seed.record, Region(low=0.7, high=1.0, sign=1)
    for p_star, regions, drawn in (
        (0.5, [ahead], 1),
        (None, [ahead], 0),
        (0.0, [ahead], 0),
        (0.5, [], 0),
    ):
        pictures, said = _panel(record, (1,), ((0.0, 0.7),), *regions, p_star=p_star)
        assert (len(pictures), len(said)) == (drawn, 1 - drawn)
    assert said == [
        "Shared fault: gru-dcc is ahead where the fault is frequent; how rare it may be is open."
    ]


def test_long_labels_are_cut() -> None:
    assert shortened("short", 100, 12) == "short"
    cut = shortened("a_very_long_name_indeed", 60, 12)
    assert cut.endswith("…")
    assert text_width(cut, 12) <= 60


def test_wide_letters_count_as_wide() -> None:
    assert text_width("推定器", 12) == 36
    assert text_width(shortened("推定器" * 9, 60, 12), 12) <= 60


def test_the_counts_of_a_grid_with_many_pairs_fit_into_its_width() -> None:
    """The last count of 10,000 scenes with three seeds was cut off."""
    for most, lines in ((99, 1), (30_000, 2), (300_000, 2)):
        drawn = pair_grid("shared", (), dict.fromkeys(PairKind, most), {})
        texts = re.findall(r'<text[^>]*class="small soft"[^>]*>([^<]*)', drawn)
        assert len(texts) == lines
        assert max(text_width(text, 11) for text in texts) <= 390
        assert sum(text.count(str(most)) for text in texts) == len(PairKind)


def test_bold_letters_count_as_wider() -> None:
    """A long title stuck out of its picture, cut as if its letters were light."""
    svg = Svg(100, 20, "")
    svg.text(0, 9, "n" * 60, "head", room=100)
    (cut,) = re.findall(">(n+…)<", svg.render())
    assert text_width(cut, 13) < 100 / 1.09
