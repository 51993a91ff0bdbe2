"""Who reads what, in a system whose observer reconstructs wind and whose filter reads the wind."""

import time
from itertools import pairwise

import pytest
from pydantic import ValidationError

from faultpath.errors import UserError
from faultpath.interface import (
    Channel,
    Interface,
    Provenance,
    Source,
    Uncertainty,
    groups,
    modules,
    rank,
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


def layered(layers: int, closing: bool = False) -> Interface:
    """Return an interface of layers of two modules, each of which reads both of the layer above.

    There are 2 ** layers ways from top to bottom. `closing` joins the last layer to the first.
    """

    def name(layer: int, side: str) -> str:
        return f"m{layer}{side}"

    modules_of = [[name(layer, side) for side in "ab"] for layer in range(layers)]
    made = [f"{module}_out" for layer in modules_of for module in layer]
    sources = (
        source("sensor"),
        *(Source(name=each, unit="1", provenance=Provenance.RECONSTRUCTED) for each in made),
    )
    channels = [Channel(name="first", sources=("sensor",), consumers=("m0a.x", "m0b.x"))]
    for above, below in pairwise(modules_of):
        for module in above:
            readers = tuple(f"{reader}.{module}" for reader in below)
            channels.append(Channel(name=module, sources=(f"{module}_out",), consumers=readers))
    ends = ("m0a.end",) if closing else ("pilot.end",)
    last = modules_of[-1][0]
    channels.append(Channel(name="last", sources=(f"{last}_out",), consumers=ends))
    return Interface(
        name="layers",
        sources=sources,
        channels=tuple(channels),
        reconstructs={m: f"{m}_out" for layer in modules_of for m in layer},
    )


@pytest.mark.parametrize("layers", [2, 24, 1500])
def test_the_checks_take_no_longer_than_the_interface_is_long(layers: int) -> None:
    began = time.process_time()
    interface = layered(layers)
    reached = transitive_consumers(interface, "first")
    assert len(reached) == 2 + 4 * (layers - 1) + 1
    assert time.process_time() - began < 5


@pytest.mark.parametrize("layers", [1, 24, 1500])
def test_a_long_cycle_is_found_among_many_ways(layers: int) -> None:
    with pytest.raises(ValidationError, match=r"m0a -> .*m0a is a cycle") as told:
        layered(layers, closing=True)
    assert len(str(told.value)) < 600


def test_modules_in_the_order_of_declaration() -> None:
    assert modules(INTERFACE) == ("observer", "predictor", "pilot", "guard")


def test_a_fault_reaches_through_reconstructions_of_reconstructions() -> None:
    assert transitive_consumers(INTERFACE, "mass") == (
        "observer.a",
        "predictor.b",
        "predictor.e",
        "guard.f",
        "pilot.g",
    )
    assert transitive_consumers(INTERFACE, "alarm") == ("pilot.g",)


def test_a_fault_reaches_the_readers_of_all_that_a_module_makes() -> None:
    made = {"observer": ["seen", "risk"]}
    filtering = Interface.model_validate(INTERFACE.model_dump() | {"reconstructs": made})
    assert filtering.reconstructions == (("observer", "seen"), ("observer", "risk"))
    reached = ("observer.a", "predictor.b", "predictor.e", "guard.f", "pilot.g")
    assert transitive_consumers(filtering, "mass") == reached


def test_unknown_channel_is_a_users_mistake() -> None:
    with pytest.raises(UserError, match="unknown channel 'mas'; did you mean 'mass'"):
        transitive_consumers(INTERFACE, "mas")


def test_rank_is_by_reach_then_expected_uncertainty() -> None:
    assert [channel.name for channel in rank(INTERFACE)] == ["thrust", "mass", "wind", "alarm"]


def test_groups_gather_the_channels_of_one_cause() -> None:
    assert groups(INTERFACE) == {"calibration": ("mass", "thrust")}
