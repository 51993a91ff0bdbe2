"""Question about results that other tools wrote."""

from collections.abc import Mapping, Sequence
from typing import Annotated, ClassVar, Literal, Required, cast

from pydantic import BeforeValidator, Field
from typing_extensions import TypedDict

from faultpath.run.question import GENERALISE, Flag, Generalise, UserQuestion
from faultpath.run.texts import Place, several

Name = str | float


class Row(TypedDict, total=False):
    """One trial: a row of a CSV or Parquet file, or a line of JSON. Other columns are ignored."""

    variant: Annotated[
        Name | None, Field(description="The version, unless it is named with the file.")
    ]
    scene: Required[
        Annotated[Name, Field(description="Two trials of one scene and seed are a pair.")]
    ]
    seed: Annotated[Name | None, Field(description="Seed or number of the trial in its scene.")]
    task: Annotated[Name | None, Field(description="Task that the scene is of.")]
    condition: Annotated[
        Name | None,
        Field(
            description="`nominal`, `shared`, or the name of the module that alone had the fault."
        ),
    ]
    success: Required[
        Annotated[
            bool | float | str | None,
            Field(
                description="true or false, 1 or 0; `crash`, `timeout`, or `failed` for a trial "
                "without an outcome; a score with --success-from."
            ),
        ]
    ]
    initial: Annotated[
        Name | None, Field(description="A hash of the initial state, which proves pairs.")
    ]
    time_s: Annotated[float | str | None, Field(description="Time at which it ended, s.")]


COLUMNS = tuple(Row.__annotations__)
"""Properties read of a trial; each is also the name of its column where none is given."""


def _columns(flags: object) -> object:
    if isinstance(flags, Mapping):
        columns = dict(cast("Mapping[str, str]", flags))
    else:
        pairs = [str(flag).partition("=") for flag in several(flags)]
        if bad := [name for name, equals, column in pairs if not (name and equals and column)]:
            raise ValueError(f"'{bad[0]}' is not of the form scene=episode_id")
        columns = {name: column for name, _, column in pairs}
        if len(columns) < len(pairs):
            raise ValueError("gives one of them two columns: name each once")
    if odd := sorted(set(columns) - set(COLUMNS)):
        raise ValueError(f"'{odd[0]}' is nothing that is read: choose from {', '.join(COLUMNS)}")
    return columns


def _metrics(flags: object) -> object:
    metrics = several(flags)
    names = [str(metric).partition(":")[0] for metric in cast("Sequence[object]", metrics)]
    if len(set(names)) < len(names):
        raise ValueError("names a metric twice: name each once")
    return metrics


class JudgeQuestion(UserQuestion):
    """Question about results that other tools wrote."""

    panel: ClassVar[str] = "What is compared"

    # Fields that only an audit's question has.
    options: ClassVar[Mapping[str, str]] = {}
    metric: ClassVar[str] = ""
    thresholds: ClassVar[tuple[float, ...]] = ()
    stop_when: ClassVar[None] = None
    margin_pp: ClassVar[None] = None

    baseline: str = Field(description="Version to compare with, as the results name it.")
    repair: str = Field(description="Version that is meant to be better.")
    columns: Annotated[
        dict[str, str], BeforeValidator(_columns), Flag("--column", several=True)
    ] = Field(
        default_factory=dict,
        description="Column by another name, scene=episode_id: of `variant` (the version), scene, "
        "seed, task, condition, success, initial (a hash of the initial state), time_s. For "
        "Inspect and lm-eval success=NAME is the scorer or metric.",
    )
    metrics: Annotated[
        tuple[str, ...], BeforeValidator(_metrics), Flag("--metric", several=True)
    ] = Field(
        default=(),
        description="Column of numbers to show beside success; NAME:less where less is better.",
    )
    success_from: float | None = Field(
        default=None, description="Score from which on a trial counts as a success."
    )
    nominal: str = Field(
        default="", description="Condition without a fault; default nominal or correct."
    )
    shared: str = Field(
        default="",
        description="Condition under which the fault reaches every module; default shared. Any "
        "other is the name of the module that alone got it.",
    )
    fault: str = Field(default="", description="What the conditions did, in words.")
    cluster: Annotated[Literal["scene", "task"], Flag(panel="How it is tested")] = Field(
        default="scene",
        description="What would be drawn anew: new scenes, or new tasks with all of their scenes.",
    )
    primary: Annotated[str | None, Flag(panel="How it is tested")] = Field(
        default=None,
        description="Where the fault acts in the primary contrast: a module, or shared (default).",
    )
    generalise: Annotated[Generalise, Flag(panel="How it is tested")] = Field(
        default="scenes", description=GENERALISE
    )
    folder: Annotated[Place, Flag("--out")] = Field(
        default=None, description="Run folder; default runs/judged-<versions>-<results>."
    )
