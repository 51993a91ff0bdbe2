"""Who reads what, in a system whose observer reconstructs wind and whose filter reads the wind."""

from faultpath.interface import (
    Channel,
    Interface,
    Provenance,
    Source,
    Uncertainty,
    groups,
    rank,
    transitive_readers,
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
        Channel(name="mass", sources=("mass_estimate",), readers=("observer.a", "predictor.b")),
        Channel(name="thrust", sources=("thrust_estimate",), readers=("observer.c", "pilot.d")),
        Channel(name="wind", sources=("still", "seen"), readers=("predictor.e", "guard.f")),
        Channel(name="alarm", sources=("risk",), readers=("pilot.g",)),
    ),
    reconstructs={"observer": "seen", "guard": "risk"},
)


def test_a_fault_reaches_through_reconstructions_of_reconstructions() -> None:
    reached = ("observer.a", "predictor.b", "predictor.e", "guard.f", "pilot.g")
    assert transitive_readers(INTERFACE, "mass") == reached
    assert transitive_readers(INTERFACE, "alarm") == ("pilot.g",)
    both = {"observer": ["seen", "risk"]}
    filtering = Interface.model_validate(INTERFACE.model_dump() | {"reconstructs": both})
    assert filtering.reconstructions == (("observer", "seen"), ("observer", "risk"))
    assert transitive_readers(filtering, "mass") == reached


def test_rank_is_by_reach_then_expected_uncertainty() -> None:
    assert [channel.name for channel in rank(INTERFACE)] == ["thrust", "mass", "wind", "alarm"]


def test_groups_gather_the_channels_of_one_cause() -> None:
    assert groups(INTERFACE) == {"calibration": ("mass", "thrust")}
