"""Who reads what, in a system whose observer reconstructs wind and whose filter reads the wind."""

import pytest

from faultpath.errors import UserError
from faultpath.interface import (
    Channel,
    Interface,
    Provenance,
    Source,
    Uncertainty,
    direct_consumers,
    feeds,
    groups,
    modules,
    rank,
    reads_of,
    transitive_consumers,
)


def source(name: str, std: float | None = None, group: str | None = None) -> Source:
    return Source(
        name=name,
        unit="1",
        provenance=Provenance.RECONSTRUCTED if name in ("seen", "risk") else Provenance.ESTIMATED,
        uncertainty=None if std is None else Uncertainty(std=std, relative=True),
        correlation_group=group,
    )


INTERFACE = Interface(
    name="chain",
    sources=(
        source("mass_estimate", 0.1, "calibration"),
        source("thrust_estimate", 0.2, "calibration"),
        source("still"),
        source("seen"),
        source("risk"),
    ),
    channels=(
        Channel(name="mass", sources=("mass_estimate",), consumers=("observer.a", "predictor.b")),
        Channel(name="thrust", sources=("thrust_estimate",), consumers=("observer.c", "pilot.d")),
        Channel(name="wind", sources=("still", "seen"), consumers=("predictor.e", "guard.f")),
        Channel(name="alarm", sources=("risk",), consumers=("pilot.g",)),
    ),
    reconstructs={"observer": "seen", "guard": "risk"},
)
STILL = {"mass": "mass_estimate", "thrust": "thrust_estimate", "wind": "still", "alarm": "risk"}


def test_modules_and_their_reads() -> None:
    assert modules(INTERFACE) == ("observer", "predictor", "pilot", "guard")
    assert reads_of(INTERFACE, "pilot") == (("thrust", "pilot.d"), ("alarm", "pilot.g"))


def test_feeds_follow_the_source_that_a_module_produces() -> None:
    assert feeds(INTERFACE, "observer") == ("predictor", "guard")
    assert feeds(INTERFACE, "observer", STILL) == ()
    assert feeds(INTERFACE, "predictor") == ()


def test_a_fault_reaches_through_reconstructions_of_reconstructions() -> None:
    assert direct_consumers(INTERFACE, "mass") == ("observer.a", "predictor.b")
    assert transitive_consumers(INTERFACE, "mass") == (
        "observer.a",
        "predictor.b",
        "predictor.e",
        "guard.f",
        "pilot.g",
    )
    assert transitive_consumers(INTERFACE, "alarm") == ("pilot.g",)


def test_bindings_cut_the_way_through_a_reconstruction() -> None:
    assert transitive_consumers(INTERFACE, "mass", STILL) == ("observer.a", "predictor.b")


def test_unknown_channel_is_a_users_mistake() -> None:
    with pytest.raises(UserError, match="unknown channel 'mas'; did you mean 'mass'"):
        transitive_consumers(INTERFACE, "mas")


def test_rank_is_by_reach_then_expected_uncertainty() -> None:
    ranked = rank(INTERFACE)
    assert [r.channel for r in ranked] == ["thrust", "mass", "wind", "alarm"]
    assert [(r.transitive, r.direct) for r in ranked] == [(5, 2), (5, 2), (3, 2), (1, 1)]
    assert [r.weight for r in ranked] == [0.2, 0.1, None, None]


def test_rank_takes_probe_responses_instead() -> None:
    ranked = rank(INTERFACE, {"mass": 0.9, "thrust": 0.3})
    assert [r.channel for r in ranked][:2] == ["mass", "thrust"]


def test_groups_gather_the_channels_of_one_cause() -> None:
    assert groups(INTERFACE) == {"calibration": ("mass", "thrust")}
