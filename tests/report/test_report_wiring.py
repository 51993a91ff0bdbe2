"""The interface drawing shows what was flown and struck, and not what a fault's words may mean."""

from itertools import pairwise
from pathlib import Path as FilePath
from xml.etree import ElementTree

import pytest

from faultpath.interface import Interface
from faultpath.record import Path, StruckTap
from faultpath.report.inputs import ReportInput
from faultpath.report.interface_drawing import draw_interface
from faultpath.report.interface_parts import concerned, tap_rows
from faultpath.report.interface_wiring import StruckPath, Who, Wiring, struck_paths
from faultpath.trials import System, SystemSpec, VariantShown, load_system, variant_shown

SVG = "{http://www.w3.org/2000/svg}"
EXAMPLES = FilePath(__file__).resolve().parents[2] / "examples"
INVERSE, MODEL = ("gain", "controller.inverse"), ("gain", "observer.model")


@pytest.fixture(scope="module")
def toy() -> System:
    return load_system(SystemSpec(name=f"{EXAMPLES / 'toy.py'}:create"))


@pytest.fixture(scope="module")
def variants(toy: System) -> tuple[VariantShown, ...]:
    """Return the calibrated cart, which has an observer, and the blind one, which has none."""
    return tuple(variant_shown(toy.variants[name]) for name in ("calibrated", "blind"))


STRUCK = (
    StruckPath("Controller only", frozenset({INVERSE}), frozenset({INVERSE})),
    StruckPath("Observer only", frozenset({MODEL}), frozenset()),
    StruckPath("Shared fault", frozenset({INVERSE, MODEL}), frozenset({INVERSE})),
)


def _words(root: ElementTree.Element) -> list[str]:
    return [text.text or "" for text in root.iter(f"{SVG}text")]


def test_taps_of_the_baseline_are_drawn_too(toy, variants) -> None:
    root = ElementTree.fromstring(draw_interface(toy.interface, STRUCK, variants))
    words = _words(root)
    assert "Controller only: struck 1 tap in both variants" in words
    assert "Observer only: struck 1 tap in the baseline alone" in words
    assert "Shared fault: struck 1 tap in both variants, 1 tap in the baseline alone" in words
    tags = [text.text for text in root.iter(f"{SVG}text") if text.get("class") == "on-tag"]
    assert sorted(tags) == ["1", "1", "2", "2b", "3", "3", "3b"]  # one of each is in the key
    (description,) = [d.text or "" for d in root.iter(f"{SVG}desc")]
    assert (
        "Observer only: struck 1 tap in the baseline alone, gain at observer.model" in description
    )


@pytest.mark.parametrize("words", ["gain:scale=0.6", "velocity:scale=2", "calibration=+0.1", ""])
def test_the_words_of_a_fault_decide_nothing(words: str, one_seed: ReportInput) -> None:
    record = one_seed.record
    question = record.question.model_copy(update={"fault": words})
    assert struck_paths(record.model_copy(update={"question": question})) == struck_paths(record)


def test_struck_taps_are_those_of_the_receipts(one_seed: ReportInput) -> None:
    def tap(channel: str, consumer: str) -> StruckTap:
        return StruckTap(channel=channel, consumer=consumer, struck_steps=1, altered_steps=0)

    paths = (
        Path(name="correct", title="Correct inputs", consumers=(), baseline_consumers=()),
        Path(
            name="shared",
            title="Shared fault",
            consumers=("a.x", "b.y"),
            baseline_consumers=("a.x",),
            struck=(tap("one", "a.x"), tap("two", "b.y")),
            baseline_struck=(tap("one", "a.x"),),
        ),
        Path(name="idle", title="Never", consumers=("a.x",), baseline_consumers=("a.x",)),
    )
    shared, idle = struck_paths(one_seed.record.model_copy(update={"paths": paths}))
    assert shared.baseline == {("one", "a.x")}
    assert shared.repair == {("one", "a.x"), ("two", "b.y")}
    assert shared.words == "Shared fault: struck 1 tap in both variants, 1 tap in the repair alone"
    assert idle.words == "Never: struck nothing"


def test_the_wiring_is_that_of_the_variants(drawn_interface: Interface) -> None:
    everything = tuple({c for channel in drawn_interface.channels for c in channel.consumers})
    baseline = VariantShown(name="zero-wind", consumers=everything, bindings={})
    repair = VariantShown(
        name="observed",
        consumers=tuple(c for c in everything if not c.startswith("planner.")),
        bindings={"wind": "reconstructed_wind"},
    )
    wiring = Wiring((baseline, repair))
    wind = drawn_interface.channel("wind")
    assert wiring.feeds(wind, "zero_wind") is Who.BASELINE
    assert wiring.feeds(wind, "reconstructed_wind") is Who.REPAIR
    assert wiring.feeds(wind, "true_wind") is Who.NEITHER
    assert wiring.feeds(drawn_interface.channel("mass"), "mass_estimate") is Who.BOTH
    assert wiring.tap(("goal", "planner.goal_cost")) is Who.BASELINE
    assert wiring.feeds(drawn_interface.channel("goal"), "mission_goal") is Who.BASELINE
    assert wiring.module("planner") is Who.BASELINE
    assert Wiring((repair, repair)).tap(("goal", "planner.goal_cost")) is Who.NEITHER


def test_a_binding_that_both_have_is_the_solid_line(drawn_interface: Interface) -> None:
    """Not the first source that the interface offers, such as no wind at all."""
    everything = tuple({c for channel in drawn_interface.channels for c in channel.consumers})
    bound = VariantShown(name="gru", consumers=everything, bindings={"wind": "reconstructed_wind"})
    text = draw_interface(drawn_interface, (), (bound, bound))
    (description,) = [d.text or "" for d in ElementTree.fromstring(text).iter(f"{SVG}desc")]
    assert "wind from reconstructed_wind to predictor.wind_map" in description
    assert "zero_wind" not in description
    declared = draw_interface(drawn_interface)
    assert "wind from zero_wind to predictor.wind_map" in declared
    solid = [text.count('class="wire"') for text in (text, declared)]
    assert solid[0] == solid[1]


def test_each_variant_has_a_sign_of_its_own_at_a_tap(toy, variants) -> None:
    root = ElementTree.fromstring(draw_interface(toy.interface, STRUCK, variants))
    tips = {
        tip.text or "": shape.get("class")
        for shape in root.iter()
        if shape.get("class") in ("tap", "tap hit", "lacking")
        for tip in shape.iter(f"{SVG}title")
    }
    assert tips["gain at observer.model, baseline calibrated: struck"] == "tap hit"
    assert tips["gain at observer.model, repair blind: not read"] == "lacking"
    assert tips["slope at controller.feedforward, repair blind"] == "tap"
    assert "r: not read" in "".join(_words(root))
    same = draw_interface(toy.interface, STRUCK, (variants[0], variants[0]))
    assert same.count('class="lacking"') == 1  # in the key
    assert "bold halo" not in same


def test_a_variant_without_a_module_says_so(toy, variants) -> None:
    without = tuple(name for name in variants[1].consumers if not name.startswith("observer."))
    bare = variants[1].model_copy(update={"consumers": without})
    assert Wiring((variants[0], bare)).lacking(MODEL) == ("", "no module")
    assert Wiring((bare, variants[1])).lacking(MODEL) == ("no module", "not read")
    assert Wiring((bare, bare)).lacking(INVERSE) == ("", "")


def test_first_comes_where_the_fault_goes(toy, variants) -> None:
    wiring = Wiring(variants)
    part = concerned(toy.interface, STRUCK, ("gain",), wiring)
    assert part is not None
    assert [channel.name for channel in part.channels] == ["gain", "slope"]
    assert {source.name for source in part.sources} == {"gain_estimate", "observed_slope"}
    assert part.reconstructions == (("observer", "observed_slope"),)
    assert "speedometer" not in draw_interface(part, STRUCK, variants)
    assert concerned(toy.interface, (), (), wiring) is None
    only = concerned(toy.interface, (), ("velocity",), wiring)
    assert only is not None
    assert [channel.name for channel in only.channels] == ["velocity"]


def test_taps_in_words_tell_baseline_and_repair_apart(toy, variants) -> None:
    rows = {
        (channel.name, tap.consumer): tap
        for channel in tap_rows(toy.interface, STRUCK, Wiring(variants))
        for tap in channel.taps
    }
    assert rows[INVERSE].said == ("struck on 1, 3", "struck on 1, 3")
    assert rows[MODEL].said == ("struck on 2, 3", "not read")
    assert rows[MODEL].struck == (True, False)
    assert rows[MODEL].absent == (False, True)
    assert rows["slope", "controller.feedforward"].said == ("reads", "reads")


def test_tags_stay_apart(toy, variants) -> None:
    root = ElementTree.fromstring(draw_interface(toy.interface, STRUCK * 4, variants))
    rows: dict[str, list[tuple[float, float]]] = {}
    for rect in root.iter(f"{SVG}rect"):
        if rect.get("class") == "tag":
            x, width = float(rect.get("x", "0")), float(rect.get("width", "0"))
            rows.setdefault(rect.get("y", ""), []).append((x, x + width))
    for spans in rows.values():
        ordered = sorted(spans)
        assert all(a[1] <= b[0] for a, b in pairwise(ordered))
