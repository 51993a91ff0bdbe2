"""What each variant may know, and what variants of a contrast share."""

import pytest
import torch
from faultpath_quadrotor.plant.module import VehiclePlant
from flights import HELD_OUT, bits, fly, quadrotor, wire

from faultpath.loop import IllegalRead

VARIANTS = ("zero-wind", "dob", "true-wind")
pytestmark = pytest.mark.usefixtures("short")


def _mistake(monkeypatch, source, wrong):
    """Let the plant say something else of a source; who reads it shows."""
    sense = VehiclePlant.sense

    def sensed(self, state):
        found = sense(self, state)
        return {**found, source: wrong(found[source])}

    monkeypatch.setattr(VehiclePlant, "sense", sensed)


@pytest.mark.parametrize(
    ("predictor", "variant", "source"),
    [
        ("dki-drag", "zero-wind", "zero_wind"),
        ("dki-drag", "dob", "reconstructed_wind"),
        ("dki-drag", "true-wind", "true_wind"),
        ("true-parameter", "dob", "reconstructed_wind"),
    ],
)
def test_only_who_says_so_reads_the_true_wind_or_physics(predictor, variant, source, monkeypatch):
    system = quadrotor(predictor=predictor, wind="L3")
    (plain,), _ = fly(system, variant)
    _mistake(monkeypatch, "true_wind", lambda wind: torch.full_like(wind, 99.0))
    (blown,), taps = fly(system, variant)
    assert (bits(blown) == bits(plain)) == (variant != "true-wind")
    assert taps.bindings["wind"] == source
    _mistake(monkeypatch, "true_physics", lambda physics: 3.0 * physics)
    (other,), _ = fly(system, variant)
    assert (bits(other) == bits(blown)) == (predictor != "true-parameter")


@pytest.mark.parametrize(
    ("variant", "predictor", "source"),
    [
        ("true-wind", "dki", "true_wind"),
        ("dob", "true-parameter", "true_physics"),
        ("zero-wind", "dki", "true_clearance"),
    ],
)
def test_a_privileged_source_needs_its_permission(variant, predictor, source):
    system = quadrotor(predictor=predictor)
    taps = wire(system, variant, HELD_OUT[:1], without=frozenset({source}))
    with pytest.raises(IllegalRead, match=source):
        system.run(variant, HELD_OUT[:1], taps, 0)


def test_variants_of_a_contrast_meet_the_same_conditions():
    system = quadrotor(wind="L2")
    ends = [fly(system, variant, HELD_OUT[:2])[0] for variant in VARIANTS]
    for first, *rest in zip(*ends, strict=True):
        for other in rest:
            assert other.disturbance_hash == first.disturbance_hash
            assert other.initial_hash == first.initial_hash
            assert other.planner_noise_hash == first.planner_noise_hash
            assert bits(other)[-1] != bits(first)[-1]
