"""Pictures: well-formed, nothing overlaps, and what is marked is what was struck."""

import re
from dataclasses import replace
from itertools import combinations, pairwise
from xml.etree import ElementTree

import pytest

from faultpath.interface import Interface
from faultpath.record import wording
from faultpath.record.model import PathBreakEven
from faultpath.report.figures.effects import effect_rows, forest, secondary_panel
from faultpath.report.figures.frequency import frequency_panel, shared_range
from faultpath.report.figures.outcomes import outcome_bars
from faultpath.report.figures.pairs import pair_grid, pair_key
from faultpath.report.inputs import ReportInput
from faultpath.report.interface_drawing import draw_interface
from faultpath.report.interface_layout import CHANNEL_HEIGHT, SOURCE_HEIGHT, lay_out
from faultpath.report.interface_wiring import struck_paths
from faultpath.report.pairing import read_pairs
from faultpath.report.scale import Axis, covering
from faultpath.report.svg import Svg, number, shortened, text_width, wrapped
from faultpath.statistics import BreakEven, Estimate, Region

SVG = "{http://www.w3.org/2000/svg}"


def _apart(centres: list[float], least: float) -> bool:
    ordered = sorted(centres)
    return all(b - a >= least - 1e-9 for a, b in pairwise(ordered))


def test_nothing_in_the_interface_overlaps(drawn_interface: Interface) -> None:
    layout = lay_out(drawn_interface)
    assert _apart(list(layout.sources.values()), SOURCE_HEIGHT + 4)
    assert _apart(list(layout.channels.values()), CHANNEL_HEIGHT + 4)
    assert _apart(list(layout.taps.values()), 16)
    for a, b in combinations(layout.modules, 2):
        assert a.bottom < b.top or b.bottom < a.top
    assert max(m.bottom for m in layout.modules) <= layout.bottom


def test_every_read_is_one_tap(drawn_interface: Interface) -> None:
    reads = {(c.name, consumer) for c in drawn_interface.channels for consumer in c.consumers}
    assert set(lay_out(drawn_interface).taps) == reads


def test_struck_taps_follow_the_fault(one_seed: ReportInput) -> None:
    predictor, reconstruction, shared = struck_paths(one_seed.record)
    head = {("mass", "reconstruction.head"), ("thrust_scale", "reconstruction.head")}
    assert reconstruction.taps == head
    # The wind map also reads the wind, which the fault on the calibration leaves alone.
    assert ("wind", "predictor.wind_map") not in predictor.taps
    assert shared.taps == predictor.taps | reconstruction.taps


def test_standalone_drawing_is_xml_with_every_name(one_seed: ReportInput) -> None:
    struck = struck_paths(one_seed.record)
    root = ElementTree.fromstring(draw_interface(one_seed.interface, struck, one_seed.variants))
    words = [t.text or "" for t in root.iter(f"{SVG}text")]
    for source in one_seed.interface.sources:
        assert source.name in words
    for channel in one_seed.interface.channels:
        assert channel.name in words
    assert root.find(f"{SVG}style") is not None
    hits = [p for p in root.iter(f"{SVG}polygon") if p.get("class") == "tap hit"]
    # Both variants have a sign at each tap, and the key has one for each path.
    assert len(hits) == 2 * len({tap for path in struck for tap in path.taps}) + len(struck)


def test_labels_of_the_drawing_stay_inside(drawn_interface: Interface) -> None:
    root = ElementTree.fromstring(draw_interface(drawn_interface))
    width = float(root.get("width", "0"))
    for text in root.iter(f"{SVG}text"):
        if text.get("text-anchor") is None:
            start = float(text.get("x", "0"))
            assert start + 0.9 * text_width(text.text or "", 11) <= width


def test_empty_interface_can_be_drawn() -> None:
    ElementTree.fromstring(draw_interface(Interface(name="empty", sources=(), channels=())))


def test_all_figures_are_xml(one_seed: ReportInput) -> None:
    record = one_seed.record
    pairs = read_pairs(one_seed.outcomes, record)
    rows = effect_rows(record)
    drawn = [
        forest(rows, "a<b", "c&d"),
        forest(rows, "a<b", "c&d", narrow=True),
        pair_grid('"<title>"', pairs, {"timeout": "<late>"}),
        pair_grid("nothing", (), {}),
        outcome_bars("<x>", record.cells, {"timeout": "<late>"}),
        *(sign for sign, _ in pair_key(pairs)),
        *(frequency_panel(b, "<&>", shared_range(record.break_even)) for b in record.break_even),
    ]
    for picture in drawn:
        ElementTree.fromstring(picture)


def test_a_secondary_outcome_looks_decided_nowhere() -> None:
    """Its interval leaves out zero, and yet it gets no dot, no colour and no winner."""
    e = Estimate(
        value=0.9, low=0.5, high=1.4, unit="m", method="m", estimand="e", n_scenes=9, n_seeds=1
    )
    panel = secondary_panel("distance", "m", [("shared", e), ("none", None)], "less")
    assert "dot" not in panel
    assert not re.search(r'class="[^"]*(repair|baseline|bold)', panel)
    assert "secondary; less is better" in panel


def _row(one_seed: ReportInput, **changes: object) -> str:
    row = replace(effect_rows(one_seed.record)[0], **changes)
    return forest([row], "a", "b")


def test_only_a_decided_difference_is_bold(one_seed: ReportInput) -> None:
    for sign in (-1, 0, 1):
        value = f">{effect_rows(one_seed.record)[0].effect.value:+.1f}".replace("-", "−")
        (drawn,) = (line for line in _row(one_seed, sign=sign).split("<text") if value in line)
        assert ("bold" in drawn) == (sign != 0)


def test_a_dot_is_filled_for_what_is_decided_and_for_nothing_else(one_seed: ReportInput) -> None:
    for sign, look in ((1, "dot repair"), (-1, "dot baseline"), (0, "dot open")):
        drawn = _row(one_seed, sign=sign)
        assert re.findall(r'class="(dot[^"]*)"', drawn) == [look]
    drawn = _row(one_seed, note="primary, floor")
    assert "primary, floor" in drawn


def test_system_names_its_own_ends(one_seed: ReportInput) -> None:
    cells = [cell for cell in one_seed.record.cells if cell.timeout]
    drawn = outcome_bars("x", cells, {"timeout": "missed"})
    assert "missed" in drawn
    assert "timeout" not in re.sub(r'class="[^"]*"', "", drawn)


def _panel(words: str, pieces: tuple[tuple[float, float], ...], *regions: Region) -> str:
    kind = "whole" if pieces == ((0.0, 1.0),) else "interval" if pieces else "empty"
    result = BreakEven(
        p_star=None, pieces=pieces, kind=kind, regions=regions, words="", method="", estimand=""
    )
    curve = ((0.0, -10.0, -20.0, 0.0), (1.0, 10.0, 0.0, 20.0))
    path = PathBreakEven(path="shared", result=result, curve=curve, words=words)
    return frequency_panel(path, "Shared", shared_range([path]))


def test_the_curve_is_coloured_where_an_arm_is_decided_to_be_ahead() -> None:
    regions = (Region(low=0.0, high=0.3, sign=-1), Region(low=0.7, high=1.0, sign=1))
    drawn = _panel("a is ahead", ((0.3, 0.7),), *regions)
    assert drawn.count('class="curve baseline"') == drawn.count('class="curve repair"') == 1
    assert drawn.count('class="star-range"') == 1
    assert "share of episodes with the fault, %" in drawn
    assert "expected difference in success, pp" in drawn
    silent = _panel("", ((0.3, 0.7),), *regions)
    assert "curve baseline" not in silent
    assert "curve repair" not in silent
    assert "No frequency is decided." in silent
    both = _panel("b is ahead", ((0.0, 0.2), (0.6, 1.0)), Region(low=0.2, high=0.6, sign=1))
    assert both.count('class="star-range"') == 2


def test_axes_cover_and_ticks_are_round() -> None:
    axis = covering([-13.9, 19.0]).at(0.0, 330.0)
    assert axis.low < -13.9
    assert axis.high > 19.0
    assert [t for t in axis.ticks(5) if t % 10] == []
    assert Axis(0, 1, 10, 20)(0.5) == 15
    assert covering([]).low < 0 < covering([]).high


@pytest.mark.parametrize("value", [0.0, -0.001, 0.5, -0.5, 10, 100.25, -7])
def test_coordinates_survive_shortening(value: float) -> None:
    assert float(number(value)) == pytest.approx(value, abs=0.005)


def test_long_labels_are_cut_or_wrapped() -> None:
    assert shortened("short", 100, 12) == "short"
    cut = shortened("a_very_long_name_indeed", 60, 12)
    assert cut.endswith("…")
    assert text_width(cut, 12) <= 60
    assert len(wrapped("one two three four five six", 40, 12, 2)) == 2


def test_text_is_escaped() -> None:
    svg = Svg(10, 10, "<t>", "&")
    svg.text(0, 0, "<script>", tip='"')
    with svg.group("g", "<tip>", data_scene='"x"'):
        svg.rect(0, 0, 1, 1, '"')
    assert "<script>" not in svg.render()
    ElementTree.fromstring(svg.render())


def test_words_of_numbers() -> None:
    assert wording.signed(-9.66) == "−9.7"
    assert wording.signed(-0.01) == "0.0"
    assert wording.plain(-0.01) == "0.0"
    assert wording.p_value(0.0004) == "< 0.001"
    assert wording.typeset("from -6.3 pp [-13.9, 1.3] at gru-2, 1-3") == (
        "from −6.3 pp [−13.9, 1.3] at gru-2, 1-3"
    )


@pytest.mark.parametrize(
    ("p_star", "kind", "pieces", "said"),
    [
        (0.588, "interval", ((0.3349, 0.7981),), "59 % [33, 80]"),
        (None, "interval", ((0.7, 1.0),), "[70, 100]"),
        (0.1, "two pieces", ((0.0, 0.12), (0.8, 1.0)), "10 % [0, 12] and [80, 100]"),
        (0.5, "whole", ((0.0, 1.0),), "any"),
        (None, "empty", (), "none"),
    ],
)
def test_a_set_of_frequencies_is_written_with_its_ends_outwards(p_star, kind, pieces, said) -> None:
    result = BreakEven(
        p_star=p_star, pieces=pieces, kind=kind, regions=(), words="", method="", estimand=""
    )
    assert wording.break_even(result) == said
