"""Interfaces as YAML: exact round trips, and a sentence with file and line for every mistake."""

import re
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pydantic import ValidationError

from faultpath.core.errors import UserError
from faultpath.interface import (
    Channel,
    Interface,
    Provenance,
    Source,
    Uncertainty,
    interface_yaml,
    read_interface,
)

names = st.from_regex(r"[a-z][a-z0-9_]{0,8}", fullmatch=True)
seen = st.characters(exclude_categories=["Cc", "Cs", "Zl", "Zp"])
words = st.text(seen | st.just("\n"), max_size=12)
amounts = st.floats(0, 1e6)
uncertainties = st.builds(Uncertainty, std=amounts, relative=st.booleans(), words=words)


@st.composite
def interfaces(draw: st.DrawFn) -> Interface:
    chosen = draw(st.lists(names, min_size=1, max_size=4, unique=True))
    shape = draw(st.sampled_from([(), (3,), (3, 3)]))
    default = draw(st.floats(-1e9, 1e9) | st.tuples(*[st.floats(-1, 1)] * 3))
    produced = draw(st.booleans())
    sources = tuple(
        Source(
            name=f"{name}_source",
            unit=draw(words),
            shape=shape,
            provenance=Provenance.RECONSTRUCTED if produced and i == 0 else Provenance.MEASURED,
            latency_s=draw(amounts),
            rate_hz=draw(st.none() | st.floats(0.1, 1e3)),
            uncertainty=draw(st.none() | uncertainties),
            description=draw(words),
        )
        for i, name in enumerate(chosen)
    )
    channels = tuple(
        Channel(
            name=name,
            sources=(source.name,),
            consumers=(f"{'pilot' if i == 0 else 'reader'}.{name}",),
            erasure_default=default if shape or isinstance(default, float) else 0.5,
            description=draw(words),
        )
        for i, (name, source) in enumerate(zip(chosen, sources, strict=True))
    )
    # Only a second channel gives the producer something to read without reading itself.
    produced = produced and len(chosen) > 1
    if not produced:
        sources = tuple(s.model_copy(update={"provenance": Provenance.PRIVILEGED}) for s in sources)
    made = {"reader": sources[0].name} if produced else {}
    return Interface(name="some", sources=sources, channels=channels, reconstructs=made)


@settings(max_examples=25, deadline=None)
@given(interfaces())
def test_text_round_trip_is_exact(interface: Interface) -> None:
    assert read_interface(interface_yaml(interface)) == interface
    assert Interface.model_validate_json(interface.model_dump_json()) == interface


GOOD = """\
name: toy
sources:
- name: mass_estimate
  unit: kg
  provenance: estimated
channels:
- name: mass
  sources: [mass_estimate]
  consumers:
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
        assert read_interface(interface_yaml(interface)) == interface
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
        (
            "unit: kg",
            "unit: !!python/object:os.system {}",
            "line 4: tags are not read; drop '!!python/object",
        ),
        ("unit: kg", "unit: \x07", "is not plain YAML (unacceptable character"),
        ("unit: kg", "unit: kg\n  unit: g", "line 5: key 'unit' appears twice; drop one"),
        ("[mass_estimate]", "&a [mass_estimate]\n  extra: *a", "line 9: aliases are not read"),
        ("  unit: kg\n", "", "line 3: sources[0].unit: is missing: add it"),
        (
            "provenance: estimated",
            "provenance: guessed",
            "line 5: sources[0].provenance: is 'guessed', and must be 'measured', 'estimated'",
        ),
        ("unit: kg", "unti: kg", "(1 more to correct after it)"),
        (
            "consumers:",
            "cnosumers:",
            "line 9: channels[0].cnosumers: is no field; did you",
        ),
        (
            "- planner.hover",
            "- planner.hover\n  gapp: none",
            "line 12: channels[0].gapp: is no field; did you mean 'gap'?",
        ),
        (
            "[mass_estimate]",
            "[mass]",
            "line 8: channel 'mass': unknown source 'mass'; known: mass_",
        ),
        (
            "- planner.hover",
            "- predictor.dynamics",
            "line 11: channel 'mass': consumer 'predictor.dynamics' is declared twice; drop one",
        ),
        ("name: toy\n", "name: toy\nreconstructs: {gru: mass_estimate}\n", "line 2: reconstructs:"),
        (
            "- planner.hover",
            "- planner",
            "line 11: channels[0].consumers[1]: is 'planner'",
        ),
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
