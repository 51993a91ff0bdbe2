"""What an interface accepts, and the sentence for what it refuses."""

import re

import pytest
from pydantic import ValidationError

from faultpath.interface import Channel, Interface, Source, Uncertainty

MASS = Source(name="mass_estimate", unit="kg", provenance="estimated")
WIND = Source(name="observed_wind", unit="m/s", shape=(3,), provenance="reconstructed")
ZERO = Source(name="zero_wind", unit="m/s", shape=(3,), provenance="constant")


def channel(name: str = "mass", **fields: object) -> Channel:
    given = {"sources": ("mass_estimate",), "consumers": ("predictor.dynamics",)} | fields
    return Channel.model_validate({"name": name} | given)


def build(**fields: object) -> Interface:
    given = {"name": "toy", "sources": (MASS,), "channels": (channel(),)} | fields
    return Interface.model_validate(given)


@pytest.mark.parametrize(
    ("fields", "sentence"),
    [
        ({"sources": (MASS, MASS)}, "source 'mass_estimate' is declared twice; drop one"),
        ({"channels": (channel(), channel())}, "channel 'mass' is declared twice; drop one"),
        (
            {"channels": (channel(consumers=("a.b", "a.b")),)},
            "channel 'mass': consumer 'a.b' is declared twice; drop one",
        ),
        (
            {"channels": (channel(sources=("mass_estimat",)),)},
            "channel 'mass': unknown source 'mass_estimat'; did you mean 'mass_estimate'? "
            "known: mass_estimate",
        ),
        (
            {
                "sources": (MASS, ZERO),
                "channels": (channel(sources=("mass_estimate", "zero_wind")),),
            },
            "channel 'mass': source 'zero_wind' ([3], m/s) cannot stand in for 'mass_estimate' "
            "([], kg); sources of one channel share shape and unit",
        ),
        (
            {"channels": (channel(erasure_default=(1.0, 2.0)),)},
            "channel 'mass': erasure_default has shape [2] and the reading of one scene has []",
        ),
        (
            {"sources": (MASS.model_copy(update={"correlation_group": "mass"}),)},
            "correlation group 'mass' has the name of a channel; rename one, because a fault may "
            "name either",
        ),
        (
            {"reconstructs": {"observer": "mass_estimate"}},
            "reconstructs: module 'observer' reads no channel; name its consumers in the channels "
            "that it reads, known modules: predictor",
        ),
        (
            {"sources": (MASS, WIND), "reconstructs": {"predictor": ["observed_wind"] * 2}},
            "reconstructs: module 'predictor': source 'observed_wind' is declared twice; drop one",
        ),
        (
            {"reconstructs": {"predictor": "wind"}},
            "reconstructs: unknown source 'wind'; known: mass_estimate",
        ),
        (
            {"reconstructs": {"predictor": "mass_estimate"}},
            "reconstructs: module 'predictor' produces source 'mass_estimate', whose provenance is "
            "estimated; make it reconstructed",
        ),
        (
            {"sources": (MASS, WIND)},
            "source 'observed_wind' is reconstructed but no module produces it; add it to "
            "reconstructs",
        ),
    ],
)
def test_refuses_what_does_not_fit(fields: dict[str, object], sentence: str) -> None:
    with pytest.raises(ValidationError) as caught:
        build(**fields)
    assert [error["msg"] for error in caught.value.errors()] == [sentence]


def test_refuses_reconstructions_in_a_circle() -> None:
    one = WIND.model_copy(update={"name": "one"})
    two = WIND.model_copy(update={"name": "two"})
    with pytest.raises(ValidationError, match=re.escape("a -> b -> a is a cycle; a module that")):
        build(
            sources=(one, two),
            channels=(
                channel("first", sources=("one",), consumers=("b.input",)),
                channel("second", sources=("two",), consumers=("a.input",)),
            ),
            reconstructs={"a": "one", "b": "two"},
        )


def test_uncertainty_is_one_of_two() -> None:
    for both in ({}, {"std": 1.0, "half_range": 1.0}):
        with pytest.raises(ValidationError, match="give either std or half_range"):
            Uncertainty(**both)


def test_expected_uncertainty_is_relative_to_the_typical_value() -> None:
    def expected(**fields: object) -> float | None:
        return MASS.model_copy(update=fields).expected_uncertainty

    assert expected() is None
    assert expected(uncertainty=Uncertainty(std=0.1, relative=True)) == 0.1
    assert expected(uncertainty=Uncertainty(std=0.1)) is None
    assert expected(uncertainty=Uncertainty(std=0.1), scale=2.0) == 0.05
    assert expected(uncertainty=Uncertainty(half_range=0.3, relative=True)) == pytest.approx(
        0.3 / 3**0.5
    )
