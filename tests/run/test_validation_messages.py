"""What does not fit a model of data is told in words of our own, and completely."""

import re
from pathlib import Path
from typing import Literal

import pytest
from pydantic import PositiveFloat, TypeAdapter, ValidationError

from faultpath.analyses.map.model import MapResult
from faultpath.core.error_source import described
from faultpath.core.results import Frozen
from faultpath.core.validation_messages import Misfit, misfit_of
from faultpath.faults import Fault, Scale
from faultpath.run.deliveries import Deliveries

SRC = Path(__file__).resolve().parents[2] / "src" / "faultpath"


class Attitude(Frozen):
    columns: tuple[str, str, str, str]
    order: Literal["wxyz", "xyzw"]


class Thrust(Frozen):
    column: str
    newton_per_unit: float | Literal["fit"] = 1.0


class ColumnMap(Frozen):
    attitude: Attitude
    thrust: Thrust
    frame: Literal["NED", "ENU"]
    mass_kg: PositiveFloat | None = None
    drag_kgps: tuple[PositiveFloat, PositiveFloat, PositiveFloat] | None = None


MAP = {
    "attitude": {"columns": [*"abcd"], "order": "wxyz"},
    "thrust": {"column": "x"},
    "frame": "NED",
}
PYDANTIC = re.compile(
    r"[Ii]nput should|[Ff]ield required|[Ee]xtra inputs|not permitted|unable to parse|Value error|"
    r"validation error|pydantic|Tuple should|String should|List should|input_value"
)


@pytest.mark.parametrize("model", [Deliveries, MapResult])
@pytest.mark.parametrize("number", [0, 9])
def test_a_format_that_no_version_wrote_is_refused(model: type, number: int) -> None:
    with pytest.raises(ValidationError) as caught:
        TypeAdapter(model).validate_python({"format": number})
    assert ("format",) in [each["loc"] for each in caught.value.errors()]


def test_a_copy_of_a_result_gets_no_field_that_is_not_declared() -> None:
    thrust = Thrust(column="x")
    assert thrust.model_copy(update={"column": "y"}) == Thrust(column="y")
    with pytest.raises(TypeError, match="Thrust has no field 'colum'"):
        thrust.model_copy(update={"colum": "y"})


def misfit(model: type, given: object) -> Misfit:
    with pytest.raises(ValidationError) as caught:
        model.model_validate(given)
    return misfit_of(caught.value, model)


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"frame": "UP"}, "frame: is 'UP', and must be 'NED' or 'ENU'"),
        ({"fram": "NED"}, "fram: is no field; did you mean 'frame'?"),
        ({"attitude": {"columns": ["q"], "order": "wxyz"}}, "attitude.columns[1]: is missing"),
        ({"attitude": {"columns": [*"abcde"], "order": "wxyz"}}, "of at most 4 values, and has 5"),
        ({"attitude": {"colums": [*"abcd"], "order": "wxyz"}}, "did you mean 'columns'?"),
        ({"thrust": {"column": ["x"]}}, "thrust.column: is ['x'], and must be text"),
        ({"thrust": {"column": "x", "newton_per_unit": "fot"}}, "must be a number or 'fit'"),
        ({"thrust": {}}, "thrust.column: is missing: add it"),
        ({"thrust": 3}, "thrust: is 3, and must be a group of fields"),
        ({"mass_kg": 0}, "mass_kg: is 0, and must be a number"),
        ({"mass_kg": float("nan")}, "mass_kg: is nan, and must be a"),
        ({"drag_kgps": [1, 2, -1]}, "drag_kgps[2]: is -1"),
    ],
)
def test_a_field_what_is_wrong_and_what_is_allowed(changed: dict[str, object], said: str) -> None:
    found = misfit(ColumnMap, MAP | changed)
    assert said in str(found)
    assert not PYDANTIC.search(str(found))


def test_the_whole() -> None:
    assert str(misfit(ColumnMap, None)).startswith("is empty, and must be")
    endless = {"channel": "c", "intervention": Scale(factor=2), "recovery_steps": 3}
    assert str(misfit(Fault, endless)).startswith("recovery_steps needs an end")


def test_no_kind_of_misfit_is_told_in_pydantic_s_words() -> None:
    """Whatever pydantic may find, of any schema that our models are made of."""

    class Odd:
        def __repr__(self) -> str:
            raise RuntimeError

    kinds = (int, float, str, bool, bytes, Path, complex, type, dict[str, int], list[int], set[int])
    kinds += (frozenset[int], tuple[int, ...], tuple[int, int], None, int | str | None, Scale)
    tried = (None, "x", "5.5", 5.5, b"\xff", {"a": "b"}, ["x"], (1,), Odd(), float("nan"), 10**30)
    told = set[str]()
    for kind in kinds:
        for given in tried:
            try:
                TypeAdapter(kind).validate_python(given)
            except ValidationError as error:
                told.add(str(misfit_of(error)))
                told.add(described(error))
    assert len(told) > 40
    assert not [said for said in told if PYDANTIC.search(said) or "\n" in said]


def test_nothing_of_ours_reads_the_sentences_of_pydantic() -> None:
    """One module words them: who else looked into an error would quote it."""
    looks = re.compile(r"error\.errors\(|\[.msg.\]|error_count\(")
    found = [
        str(file.relative_to(SRC)) for file in SRC.rglob("*.py") if looks.search(file.read_text())
    ]
    assert found == ["core/validation_messages.py"]
