"""Question of a sensitivity analysis; flags, keywords and help follow, as for others."""

from typing import Annotated, ClassVar

from pydantic import AfterValidator, BeforeValidator, Field

from faultpath.trials.question import Flag, Placed, Request
from faultpath.trials.texts import LARGEST, read_seeds, several


def _power_of_two(points: int) -> int:
    if points & (points - 1):
        below = 1 << (points.bit_length() - 1)
        raise ValueError(f"is {points}: a design takes a power of two, as {below} or {2 * below}")
    return points


class SensitivityQuestion(Placed, Request):
    """Question that a sensitivity analysis answers."""

    panel: ClassVar[str] = "What is varied"

    variant: str = Field(description="Variant whose inputs err.")
    fault: Annotated[tuple[str, ...], BeforeValidator(several), Flag(several=True)] = Field(
        default=(),
        description="Largest error of a source that declares none, or another one, of either sign: "
        "`gain:scale=1.1`; repeat the option for more.",
    )
    metric: str = Field(default="", description="Metric to explain; default success.")
    scenes: int | None = Field(default=8, description="Run the first N scenes.")
    seeds: Annotated[tuple[int, ...], BeforeValidator(read_seeds)] = Field(
        default=(0,), description="Seeds of the noise, and of trained models where there are any."
    )
    points: Annotated[int, AfterValidator(_power_of_two)] = Field(
        default=64,
        ge=64,
        le=65_536,
        description="Points of the design, a power of two; each takes as many runs of every scene "
        "as there are groups of sources, and two.",
    )
    design_seed: int = Field(
        default=0, ge=0, le=LARGEST, description="Seed of the design; not that of the trials."
    )
