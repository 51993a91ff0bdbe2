"""The options of a system: what its factory says of them, and what it is handed."""

from enum import Enum
from typing import TYPE_CHECKING, Annotated, Literal

import pytest
from pydantic import BaseModel, Field, model_validator

from faultpath.core.errors import UserError
from faultpath.system import Offered, Option
from faultpath.system.options import as_text, call, options_of

if TYPE_CHECKING:
    from somewhere import Nothing


class Gear(Enum):
    LOW = "low"
    HIGH = "high"


class Settings(BaseModel):
    gear: Annotated[Gear, "Gear of the cart."] = Gear.LOW
    carts: Annotated[int, Offered(1, 2)] = 1

    @model_validator(mode="after")
    def _together(self):
        if self.gear is Gear.HIGH and self.carts == 2:
            raise ValueError("two carts have only a low gear.")
        return self


def typed(
    gear: Annotated[Literal["low", "high"], "Gear of the cart."] = "low",
    carts: int = 1,
    *,
    fast: bool = False,
    mass_kg: float | None = None,
    note="",
    own: "Nothing" = None,
) -> "Nothing":
    return gear, carts, fast, mass_kg, note, own


def modelled(settings: Settings):
    return settings


def anything(**options: str):
    return options


def limited(mass_kg: Annotated[float, Field(gt=0), "Mass of the cart."] = 1.0):
    return mass_kg


def needy(path: str):
    return path


def test_a_signature_and_a_model_say_what_there_is():
    assert options_of(typed) == (
        Option("gear", "Gear of the cart.", ("low", "high"), "low"),
        Option("carts", default="1"),
        Option("fast", choices=("true", "false"), default="false"),
        Option("mass_kg"),
        Option("note", default=""),
        Option("own"),
    )
    kinds = [option.kind for option in options_of(typed)]
    assert kinds == ["str", "int", "str", "float", "str", "str"]
    assert options_of(modelled) == (
        Option("gear", "Gear of the cart.", ("low", "high"), "low"),
        Option("carts", "", ("1", "2"), "1"),
    )
    assert options_of(lambda: None) == ()


def test_text_becomes_what_the_factory_takes():
    given = {"carts": "3", "fast": "true", "mass_kg": "1.5", "note": "4", "own": "x"}
    assert call(typed, given, "it") == ("low", 3, True, 1.5, "4", "x")
    assert call(typed, {}, "it") == ("low", 1, False, None, "", None)
    assert call(modelled, {"gear": "high"}, "it") == Settings(gear=Gear.HIGH)
    assert call(modelled, {"carts": "2"}, "it") == Settings(carts=2)
    assert call(anything, {"wind": "L3"}, "it") == {"wind": "L3"}
    plain = call(lambda fast=False, carts=1, mass=1.0: (fast, carts, mass), {"fast": "false"}, "it")
    assert plain == (False, 1, 1.0)


@pytest.mark.parametrize(
    ("factory", "given", "says"),
    [
        (typed, {"gear": "third"}, r"^unknown gear 'third'; choose one of low, high\.$"),
        (typed, {"carts": "three"}, r"^it cannot have the carts 'three': .*[^.]\.$"),
        (typed, {"carts": "1_0"}, "^it cannot have the carts '1_0': it must be a whole number"),
        (typed, {"mass_kg": "٣"}, "^it cannot have the mass_kg '٣': it must be a number"),
        (typed, {"fast": "perhaps"}, "unknown fast 'perhaps'; choose one of true, false"),
        (typed, {"colour": "red"}, "do not include 'colour': it takes gear, carts, fast, mass"),
        (modelled, {"carts": "3"}, "unknown carts '3'; choose one of 1, 2"),
        (modelled, {"gear": "high", "carts": "2"}, "of it do not fit: two carts have only a low"),
        (limited, {"mass_kg": "-1"}, "the mass_kg '-1': it is '-1', and must be a number above 0"),
        (lambda carts=1: carts, {"carts": "1.5"}, "the carts '1.5': it must be a whole number"),
        (lambda: None, {"colour": "red"}, "'colour': it takes none"),
        (needy, {}, "needs the option 'path'"),
    ],
)
def test_a_wrong_option_is_told_in_a_sentence(factory, given, says):
    with pytest.raises(UserError, match=says):
        call(factory, given, "it")


def test_options_go_to_a_factory_as_text():
    given = {"gear": Gear.HIGH, "carts": 2, "fast": True, "mass_kg": 1.5, "note": "x"}
    text = {"gear": "high", "carts": "2", "fast": "true", "mass_kg": "1.5", "note": "x"}
    assert as_text(given) == text
    with pytest.raises(UserError, match=r"'note' is a list: give text or a number"):
        as_text({"note": []})
