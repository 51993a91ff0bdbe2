"""Which errors a sensitivity analysis draws, and what it says of what came out."""

import numpy as np
import pytest
from outcome_tables import question

from faultpath.core.errors import UserError
from faultpath.decisions.sensitivity.decide import conclude
from faultpath.decisions.sensitivity.model import ResolvedSensitivity, SensitivityRecord, Uncertain
from faultpath.decisions.sensitivity.study import faults_at, uncertain
from faultpath.interface import read_interface
from faultpath.statistics.sobol import design
from faultpath.trials import System, Variant

FACTS = """
name: drawn
sources:
- {name: mass, unit: kg, provenance: estimated, correlation_group: cal, UNSURE}
- {name: thrust, unit: N, provenance: estimated, correlation_group: cal, uncertainty: {std: 2.0}}
- {name: velocity, unit: m/s, shape: [3], provenance: measured, uncertainty: {std: 0.1}}
- {name: image, unit: m, shape: [4, 4], provenance: measured, uncertainty: {half_range: 0.5}}
- {name: exact, unit: m, provenance: measured, uncertainty: {std: 0}}
- {name: silent, unit: m, provenance: measured}
- {name: truth, unit: m, provenance: privileged, uncertainty: {std: 1}}
channels:
- {name: mass, sources: [mass], consumers: [model.mass, planner.mass]}
- {name: thrust, sources: [thrust], consumers: [model.thrust, logger.file]}
- {name: speed, sources: [velocity], consumers: [model.speed]}
- {name: image, sources: [image], consumers: [planner.image]}
- {name: place, sources: [exact, truth], consumers: [planner.place]}
- {name: silent, sources: [silent], consumers: [planner.place]}
"""


class Drawn(System):
    name = "drawn"
    interface = read_interface(
        FACTS.replace("UNSURE", "uncertainty: {half_range: 0.1, relative: true}")
    )


PLACES = {place for channel in Drawn.interface.channels for place in channel.consumers}
VARIANT = Variant("v", "", frozenset(PLACES - {"logger.file"}))


def test_a_group_is_one_draw_a_vector_a_draw_a_component() -> None:
    groups, left_out = uncertain(Drawn, VARIANT, ())
    numbers = {each.name: each.numbers for each in groups}
    assert numbers == {"cal": 1, "velocity": 3, "image": 1}
    assert left_out == ("silent",)
    drawn = np.array([0.75, 0.5, 0.1, 0.9, 1.0])
    mass, thrust, speed, image = faults_at(Drawn, VARIANT, groups, drawn)
    assert mass.intervention.factor == pytest.approx(1.05)  # three quarters of the way up
    assert thrust.intervention.by == pytest.approx(2.0 * 0.6744898)  # by the same cause
    assert speed.intervention.by == pytest.approx((0.0, -0.1281552, 0.1281552))
    assert image.intervention.by == pytest.approx(0.5)
    assert mass.consumers == ("model.mass", "planner.mass")
    assert thrust.consumers == ("model.thrust",)  # whom the variant has


def test_a_given_error_takes_the_place_of_a_declared_one() -> None:
    given = ("silent:offset=0.3", "speed:scale=0.8", "cal:scale=1.2")
    groups, left_out = uncertain(Drawn, VARIANT, given)
    sizes = {p.source: (p.error.half_range, p.error.relative) for g in groups for p in g.parts}
    assert sizes["silent"] == (pytest.approx(0.3), False)
    assert sizes["velocity"] == (pytest.approx(0.2), True)
    assert sizes["mass"] == sizes["thrust"] == (pytest.approx(0.2), True)
    assert left_out == ()
    for text, said in (("thurst:offset=1", "did you mean 'thrust'"), ("mass:noise=1", "give the")):
        with pytest.raises(UserError, match=said):
            uncertain(Drawn, VARIANT, (text,))


NAMES = ("a", "b", "c")


def record(weights: tuple[float, ...], scenes: int = 4, together: float = 0.0) -> SensitivityRecord:
    """Return the record of a weighted sum of three errors, and of the product of the first two."""
    drawn = design([1, 1, 1], 256, 3) - 0.5
    same = question(scenes).model_dump(include={*ResolvedSensitivity.model_fields} - {"metric"})
    groups = tuple(Uncertain(name=name, parts=(), numbers=1) for name in NAMES)
    more = {"variant": "v", "groups": groups, "left_out": (), "points": 256, "design_seed": 3}
    more |= {"metric": "", "said": "success", "unit": "%"}
    resolved = ResolvedSensitivity.model_validate(same | more)
    return conclude(resolved, drawn @ weights + together * drawn[:, 0] * drawn[:, 1], scenes)


@pytest.mark.parametrize("scenes", [1, 2, 4])
def test_a_source_comes_first_only_where_its_share_is_decided_to_be_the_largest(scenes) -> None:
    made = record((3.0, 1.0, 0.0), scenes)
    assert made.headline.startswith("Alone, a explains more than any other source in the ")
    said = " ".join(made.sentences)
    assert "a more than b" in said
    assert "b more than a" not in said
    assert "Of c nothing is shown" in said
    assert f"the {scenes} scene" in said
    for one in made.indices:
        assert (f"{one.group}: alone it explains" in said) == (one.first.low > 0.005)


def test_ties_have_no_order_and_interactions_are_no_share_of_one() -> None:
    tied = record((1.0, 1.0, 0.0))
    assert tied.headline == "a and b each explain a share; which explains most is open."
    assert "a more than b" not in " ".join(tied.sentences)
    product = record((0.0, 0.0, 0.0), together=1.0)
    assert product.headline == "a and b matter, but no share of one alone is significant."
    assert "a: with all that it does together with others" in " ".join(product.sentences)
    nothing = record((0.0, 0.0, 0.0))
    assert (
        nothing.headline == "Success hardly varies with these errors: there is nothing to explain."
    )
    assert nothing.indices == ()
    assert "explain" not in " ".join(nothing.sentences)
