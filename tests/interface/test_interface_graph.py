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
    direct_consumers,
    feeds,
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
STILL = {"mass": "mass_estimate", "thrust": "thrust_estimate", "wind": "still", "alarm": "risk"}


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
