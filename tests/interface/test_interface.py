"""Interfaces as models and as YAML: what is accepted, what is refused, and who reads what."""

import re
from pathlib import Path

import pytest
from pydantic import ValidationError

from faultpath.core.errors import UserError
from faultpath.interface import (
    Channel,
    Interface,
    Provenance,
    Source,
    Uncertainty,
    groups,
    rank,
    read_interface,
    transitive_readers,
)

MASS = Source(name="mass_estimate", unit="kg", provenance="estimated")
WIND = Source(name="observed_wind", unit="m/s", shape=(3,), provenance="reconstructed")
ZERO = Source(name="zero_wind", unit="m/s", shape=(3,), provenance="constant")


def channel(name: str = "mass", **fields: object) -> Channel:
    given = {"sources": ("mass_estimate",), "readers": ("predictor.dynamics",)} | fields
    return Channel.model_validate({"name": name} | given)


def build(**fields: object) -> Interface:
    given = {"name": "toy", "sources": (MASS,), "channels": (channel(),)} | fields
    return Interface.model_validate(given)


STRANGE = channel(sources=("mass_estimate", "zero_wind"))
TWICE = {"predictor": ["observed_wind"] * 2}
GROUPED = MASS.model_copy(update={"correlation_group": "mass"})


@pytest.mark.parametrize(
    ("fields", "sentence"),
    [
        ({"sources": (MASS, MASS)}, "source 'mass_estimate' is declared twice"),
        ({"channels": (channel(), channel())}, "channel 'mass' is declared twice"),
        ({"channels": (channel(readers=("a.b", "a.b")),)}, "reader 'a.b' is declared twice"),
        ({"channels": (channel(sources=("mass_estimat",)),)}, "did you mean 'mass_estimate'?"),
        ({"sources": (MASS, ZERO), "channels": (STRANGE,)}, "'zero_wind' ([3], m/s) cannot stand"),
        ({"channels": (channel(erasure_default=(1.0, 2.0)),)}, "erasure_default has 2 numbers"),
        ({"sources": (GROUPED,)}, "correlation group 'mass' has the name of a channel"),
        ({"reconstructs": {"observer": "mass_estimate"}}, "module 'observer' reads no channel"),
        ({"sources": (MASS, WIND), "reconstructs": TWICE}, "'observed_wind' is declared twice"),
        ({"reconstructs": {"predictor": "wind"}}, "reconstructs: unknown source 'wind'"),
        ({"reconstructs": {"predictor": "mass_estimate"}}, "provenance is estimated"),
        ({"sources": (MASS, WIND)}, "source 'observed_wind' is reconstructed but no module"),
    ],
)
def test_refuses_what_does_not_fit(fields: dict[str, object], sentence: str) -> None:
    with pytest.raises(ValidationError) as caught:
        build(**fields)
    (error,) = caught.value.errors()
    assert sentence in error["msg"]


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


GOOD = """\
name: toy
sources:
- name: mass_estimate
  unit: kg
  provenance: estimated
channels:
- name: mass
  sources: [mass_estimate]
  readers:
  - predictor.dynamics
  - planner.hover
"""


CONTROLS = "".join(map(chr, (*range(32), *range(127, 160), 0x2028, 0x2029)))


@pytest.mark.parametrize("character", CONTROLS, ids=lambda c: f"U+{ord(c):04X}")
def test_control_characters_are_refused_and_line_breaks_come_back(character: str) -> None:
    """NEL once came back from YAML as a space."""
    described = read_interface(GOOD).model_dump(mode="json")
    described["sources"][0]["description"] = f"a{character}b"
    if character == "\n":
        interface = Interface.model_validate(described)
        assert Interface.model_validate_json(interface.model_dump_json()) == interface
        return
    with pytest.raises(ValidationError, match=rf"control character U\+{ord(character):04X}"):
        Interface.model_validate(described)
    escaped = GOOD.replace("unit: kg", f'unit: "\\u{ord(character):04x}"')
    with pytest.raises(UserError, match=r"line 4: sources\[0\]\.unit: holds the control character"):
        read_interface(escaped)


@pytest.mark.parametrize(
    ("old", "new", "sentence"),
    [
        ("unit: kg", "unit: [kg", "line 5: is not plain YAML ("),
        ("unit: kg", "unit: !!python/object:os.system {}", "line 4: tags are not read; drop '!!py"),
        ("unit: kg", "unit: \x07", "is not plain YAML (unacceptable character"),
        ("unit: kg", "unit: kg\n  unit: g", "line 5: key 'unit' appears twice; drop one"),
        ("[mass_estimate]", "&a [mass_estimate]\n  extra: *a", "line 9: aliases are not read"),
        ("  unit: kg\n", "", "line 3: sources[0].unit: is missing: add it"),
        ("provenance: estimated", "provenance: guessed", "line 5: sources[0].provenance: is 'gue"),
        ("unit: kg", "unti: kg", "line 4: sources[0].unti: is no field; did you mean 'unit'?"),
        (
            "- planner.hover",
            "- planner.hover\n  gapp: none",
            "line 12: channels[0].gapp: is no field",
        ),
        (
            "[mass_estimate]",
            "[mass]",
            "line 8: channel 'mass': unknown source 'mass'; known: mass_",
        ),
        (
            "- planner.hover",
            "- predictor.dynamics",
            "line 11: channel 'mass': reader 'predictor.",
        ),
        ("name: toy\n", "name: toy\nreconstructs: {gru: mass_estimate}\n", "line 2: reconstructs:"),
        ("- planner.hover", "- planner", "line 11: channels[0].readers[1]: is 'planner'"),
    ],
)
def test_a_mistake_is_told_with_its_line(old: str, new: str, sentence: str, tmp_path: Path) -> None:
    assert old in GOOD
    path = tmp_path / "toy.yaml"
    path.write_text(GOOD.replace(old, new, 1), encoding="utf-8")
    with pytest.raises(UserError, match=re.escape(sentence)) as caught:
        read_interface(path)
    assert str(caught.value).startswith(str(path))
    assert "\n" not in str(caught.value)


def test_a_missing_file_is_told(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="cannot be read \\(No such file or directory\\); give the"):
        read_interface(tmp_path / "none.yaml")


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


def test_modules_may_read_each_other_since_one_of_them_may_read_the_past() -> None:
    circle = {"observer": ["seen"], "guard": ["risk", "still"]}
    still = {"provenance": Provenance.RECONSTRUCTED}
    sources = [s.model_copy(update=still) if s.name == "still" else s for s in INTERFACE.sources]
    channels = [
        *INTERFACE.channels[:3],
        Channel(name="alarm", sources=("risk",), readers=("pilot.g", "observer.h")),
    ]
    changed = {"reconstructs": circle, "sources": sources, "channels": channels}
    interface = Interface.model_validate(dict(INTERFACE) | changed)
    assert transitive_readers(interface, "alarm") == (
        "pilot.g",
        "observer.h",
        "predictor.e",
        "guard.f",
    )


def test_rank_is_by_reach_then_expected_uncertainty() -> None:
    assert [channel.name for channel in rank(INTERFACE)] == ["thrust", "mass", "wind", "alarm"]


def test_groups_gather_the_channels_of_one_cause() -> None:
    assert groups(INTERFACE) == {"calibration": ("mass", "thrust")}
