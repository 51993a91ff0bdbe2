"""Questions of a user: every option of an audit, map, check and trace, declared once.

The flags of the command line, Python's keywords, their help and the checks follow
from these models. Texts are taken where the command line gives them, as in `seeds="0,1,2"`.
"""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Any, ClassVar, Literal, TypeVar

from pydantic import BeforeValidator, Field, ValidationError

from faultpath.core.errors import UserError
from faultpath.core.results import Frozen
from faultpath.core.validation_messages import misfit_of
from faultpath.faults.text import FaultText
from faultpath.run.texts import LARGEST, Names, Place, Seeds, Sizes, several

Generalise = Literal["scenes", "models"]
FEWEST_TRAININGS = 5
"""Trainings below which newly trained models get no interval: their spread is not known."""
GENERALISE = (
    "What intervals are valid for: new scenes, or newly trained models too, one a seed "
    f"({FEWEST_TRAININGS} or more). The latter takes trainings to spread evenly around their mean: "
    "a rare collapse that no training had is not seen."
)
"""Help of the option."""
StopWhen = Literal["decided", "all-decided"]


@dataclass(frozen=True)
class Flag:
    """How the command line calls and shows a field, where its name does not say."""

    name: str = ""
    several: bool = False
    """Whether the flag may be repeated."""
    panel: str = ""
    """Heading in the help; by default that of the class which declares the field."""


ADVANCED = "Advanced"
"""Heading of rarely used options; it stands last in a help."""
LibraryName = Annotated[str, Field(description="Library of scenes, by name or file.")]


class UserQuestion(Frozen, strict=True, allow_inf_nan=False):
    """Question of a call."""

    panel: ClassVar[str] = ""
    """Heading in the help of the fields that a class declares."""


_Question = TypeVar("_Question", bound=UserQuestion)


def ask(model: type[_Question], fields: Mapping[str, object], command: bool = False) -> _Question:
    """Return the question; `UserError` for a field that does not fit, by its flag if `command`."""
    try:
        return model.model_validate(dict(fields))
    except ValidationError as error:
        wrong = misfit_of(error, model)
        first = str(wrong.location[0]) if wrong.location else ""
        where = flag(model, first) if command and first in model.model_fields else wrong.where
        raise UserError(f"{where}: {wrong.message}.") from None


def flag(model: type[UserQuestion], name: str) -> str:
    """Return what the command line calls a field: `margin_pp` is `--margin`."""
    field = model.model_fields[name]
    for note in field.metadata:
        if isinstance(note, Flag) and note.name:
            return note.name
    dashed = re.sub(r"_(s|pp)$", "", name).replace("_", "-")
    return f"--no-{dashed}" if field.default is True else f"--{dashed}"


class Request(UserQuestion):
    """Question about a system."""

    library: LibraryName = "selection"
    options: Annotated[
        dict[str, Any],
        BeforeValidator(lambda options: {} if options is None else options),
        Flag("--set", several=True, panel=ADVANCED),
    ] = Field(
        default_factory=dict,
        description="System option, key=value, where a flag of the command has its name.",
    )

    @property
    def named_variants(self) -> tuple[str, ...]:
        """Variants that it names."""
        named = (vars(self).get(name) for name in ("baseline", "repair", "variant"))
        return (*(name for name in named if name), *vars(self).get("variants", ()))


class TraceQuestion(Request):
    """Question of a trace."""

    variant: str | None = Field(default=None, description="Variant; default the first.")
    steps: int = Field(default=3, ge=1, description="Control steps to trace.")
    scene: str | None = Field(default=None, description="Scene by its id; default the first.")
    seed: int = Field(default=0, ge=0, le=LARGEST, description="Seed of the trial.")
    fault: FaultText | None = Field(
        default=None, description="A fault, as in `audit`, to see whom it reaches."
    )


class CheckQuestion(Request):
    """Question of a check."""

    variants: Names = Field(
        default=(),
        description="Variants to check: old,new. Default all, or two of more than 4.",
    )
    scenes: int = Field(
        default=4, description="Run N scenes, one from each of N equal parts of the library."
    )
    fault: FaultText | None = Field(
        default=None, description="A fault, as in `audit`, under which whole trials run too."
    )
    seed: int = Field(default=0, ge=0, le=LARGEST, description="Seed of the trials.")
    workers: int | None = Field(
        default=None,
        description="Worker processes, by default 2 where that helps; 0 is this process alone, "
        "which cannot see what differs from process to process.",
    )


class RepairQuestion(Request):
    """Two variants of a system, compared in scenes."""

    panel: ClassVar[str] = "What is compared"

    baseline: str = Field(
        description="Variant to compare with, or your file.py:factory where the system takes one."
    )
    repair: str = Field(description="Variant that is meant to help, named likewise.")
    library: LibraryName = "held-out"
    scenes: int | None = Field(default=None, description="Run only the first N scenes.")
    seeds: Seeds = (0,)


class Execution(UserQuestion):
    """Where and how trials run."""

    panel: ClassVar[str] = "How it runs"

    folder: Annotated[Place, Flag("--out")] = Field(
        default=None,
        description="Run folder; default runs/<question>-<code>, so the same call resumes.",
    )
    workers: int | None = Field(
        default=None,
        description="Worker processes, 0 for this process alone; default one per core if that "
        "helps.",
    )
    executor: Annotated[str, Flag(panel=ADVANCED)] = Field(
        default="local",
        description="local, or ray for a Ray cluster: the one that RAY_ADDRESS names or that runs "
        "here, else one of its own; ray:HOST:PORT names it.",
    )
    time_limit_s: Annotated[float | None, Flag(panel=ADVANCED)] = Field(
        default=None,
        description="Seconds that a block of scenes may take; default what the system says, else "
        "3600.",
    )


class Running(Execution, RepairQuestion):
    """Two variants of a system, compared in scenes, with where and how it runs."""


class AuditQuestion(RepairQuestion):
    """Question that an audit answers."""

    panel: ClassVar[str] = "How it is tested"

    fault: Annotated[FaultText, Flag(panel=RepairQuestion.panel)] = Field(
        description="`gain:scale=0.6`, `gain:delay=5@observer`, `gain:scale=2,onset=20`, ...; "
        "one audit per size: `gain:scale=0.9,1.1` or `gain:offset=-0.2..0.2/9`."
    )
    primary: str | None = Field(
        default=None,
        description="Where the fault acts in the primary contrast: a module, or shared (default).",
    )
    generalise: Annotated[Generalise, Flag(panel=ADVANCED)] = Field(
        default="scenes", description=GENERALISE
    )
    metric: str = Field(default="", description="Metric of the system to show beside success.")
    thresholds: Annotated[Sizes, Flag(panel=ADVANCED)] = Field(
        default=(),
        description="Thresholds of --metric at which success is counted anew: 0.02,0.05,0.1.",
    )
    stop_when: Annotated[StopWhen | None, Flag(panel=ADVANCED)] = Field(
        default=None,
        description="Stop once the primary contrast is significant (`decided`), or every effect "
        "(`all-decided`): scenes in random order, at most --scenes of them.",
    )
    margin_pp: Annotated[float | None, Flag(panel=ADVANCED)] = Field(
        default=None,
        description="With --stop-when: a difference shown to be smaller than so many percentage "
        "points ends it too.",
    )


class AuditCall(AuditQuestion, Running):
    """An audit that is called for: its question, and how it runs."""

    signals: Annotated[bool, Flag(panel=ADVANCED)] = Field(
        default=True, description="Run the report's first scenes once more to plot their signals."
    )


class MapQuestion(RepairQuestion):
    """Question that a reversal map answers."""

    panel: ClassVar[str] = "What is mapped"

    fault: Annotated[FaultText, Flag(panel=RepairQuestion.panel)] = Field(
        description="Without its size: `gain`, `gain:offset`, `gain,onset=9`."
    )
    against: Names = Field(
        description="The two modules whose errors are mapped: controller,observer."
    )
    up_to: float | None = Field(
        default=None, description="Largest error, of either sign; default three declared spreads."
    )
    points: int = Field(
        default=81,
        description="Pairs of errors at most, but for those that narrow down where the ranking "
        "reverses.",
    )
    mean: Sizes = Field(
        default=(0.0,), description="Mean of the errors, one number or one a module."
    )
    spread: Sizes = Field(
        default=(), description="Standard deviation of the errors, likewise; default as declared."
    )
    correlation: float | None = Field(
        default=None,
        description="Correlation of the errors for which to report the expected difference.",
    )


class MapCall(MapQuestion, Running):
    """A map that is called for: its question, and how it runs."""


class ScanQuestion(Request):
    """Question that a scan answers: of a variant of a system, in scenes."""

    panel: ClassVar[str] = "What is scanned"

    variant: str = Field(
        description="Variant to scan, or your file.py:factory where the system takes one."
    )
    repair: str = Field(
        default="", description="Another variant, to scan with the same errors beside it."
    )
    fault: Annotated[
        tuple[FaultText, ...],
        BeforeValidator(several, json_schema_input_type=FaultText | tuple[FaultText, ...]),
        Flag(several=True),
    ] = Field(
        default=(),
        description="Size of a source's error in place of the declared one, for both signs: "
        "`gain:scale=1.2`, `gain:offset=0.1@observer`, `calibration=0.1`.",
    )
    library: LibraryName = "selection"
    scenes: int | None = Field(
        default=None,
        description="Run only the first N scenes: 50 in the first stage, the others in the second; "
        "default as many as 8000 trials allow.",
    )
    seeds: Seeds = (0,)
    trials: bool = Field(
        default=True, description="Run trials, after ranking the sources by their readers."
    )

    @property
    def variants(self) -> tuple[str, ...]:
        """The variants that are scanned."""
        return (self.variant, self.repair) if self.repair else (self.variant,)


class ScanCall(Execution, ScanQuestion):
    """A scan that is called for: its question, and how it runs."""
