"""Interfaces as YAML: a sentence with file and line for every mistake."""

import re
from pathlib import Path

import pytest
from pydantic import ValidationError

from faultpath.core.errors import UserError
from faultpath.interface import Interface, read_interface

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
        ("unit: kg", "unti: kg", "line 4: sources[0].unti: is no field; did you mean 'unit'?"),
        ("consumers:", "cnosumers:", "line 9: channels[0].cnosumers: is no field; did you"),
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
        ("- planner.hover", "- planner", "line 11: channels[0].consumers[1]: is 'planner'"),
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
