"""The question of a result, and the facts of system and library beside it."""

from collections.abc import Mapping
from typing import Annotated, Any, Literal, TypeAlias, TypeVar

from pydantic import Discriminator, Field, Tag

from faultpath.core.results import Result
from faultpath.faults import Fault
from faultpath.run.plan import SystemSpec
from faultpath.run.question import AuditQuestion, Generalise, Request
from faultpath.run.received.question import JudgeQuestion
from faultpath.stats.estimate import TESTS
from faultpath.system.declared import Library
from faultpath.system.outcome import VEHICLE, Metric, MetricName
from faultpath.system.system import System

_Question = TypeVar("_Question", bound=Request)


def _verb(question: Any) -> str:
    judged = isinstance(question, JudgeQuestion)
    if isinstance(question, Mapping):
        judged = "cluster" in question
    return "judge" if judged else "audit"


Question: TypeAlias = Annotated[
    Annotated[AuditQuestion, Tag("audit")] | Annotated[JudgeQuestion, Tag("judge")],
    Discriminator(_verb),
]
"""Question about two versions, as a result keeps it."""


def question_of(call: Request, model: type[_Question], spec: SystemSpec) -> _Question:
    """Return the question of a call as results keep it: system options as the system gets them, and
    nothing of where and how it runs."""
    fields = {name: getattr(call, name) for name in model.model_fields}
    return model.model_validate({**fields, "options": spec.options})


class Facts(Result):
    """Facts that building a system and its library gave."""

    system: str
    library: str
    library_hash: str
    trained: bool = False
    """Whether the variants hold trained models."""


def facts_of(system: System, spec: SystemSpec, library: Library) -> Mapping[str, Any]:
    """Return the fields of `Facts`."""
    return {
        "system": spec.name,
        "library": library.name,
        "library_hash": library.content_hash,
        "trained": system.trained,
    }


class SceneOrder(Result):
    """The scenes of a sequential audit."""

    scenes: tuple[str, ...]
    """In the order in which they are run, drawn before the first trial."""
    seed: int
    """Seed of the draw, with the hash of the library."""
    per_analysis: int
    """Scenes from one analysis of the results to the next."""
    trials: int
    """Trials of a scene: its distinct treatments."""


class ComparisonFacts(Facts):
    """Facts of a comparison, from a system and its library or from other tools' results."""

    n_scenes: int
    """Number of scenes; in a sequential audit the largest possible."""
    seeds: tuple[int, ...]
    primary: str = ""
    """Condition of the primary contrast, which leads the headline; empty for the default."""
    faults: tuple[Fault, ...] = ()
    """The fault channel by channel, at every reader that it names; empty where only words say."""
    ends: dict[str, str] = Field(default_factory=dict)
    """Names that the system has for its ends, where they are not the status itself."""
    metrics: dict[MetricName, Metric] = VEHICLE
    """Metrics of its trials."""
    pairing: Literal["planned", "keys", "hashes"] = "planned"
    """How the two trials of a pair are known to belong together: an audit ran them as such, other
    tools gave them the same keys, or also a hash of what they began with."""
    unit: Literal["scene", "task"] = "scene"
    """Unit that counts as one scene: a scene, or a task with all of its scenes."""
    order: SceneOrder | None = None
    """Order of the scenes of a sequential audit."""

    @property
    def judged(self) -> bool:
        """Whether other tools ran the trials."""
        return self.pairing != "planned"

    @property
    def tests(self) -> str:
        """How effects are tested and adjusted, in words; empty for a sequential audit."""
        return TESTS if self.order is None else ""


class EarlierAnalysis(Result):
    """An earlier analysis of the same trials; a result cannot allow for it."""

    scenes: int | None
    """`None` for a sequential audit, which allows for its number."""
    primary: str
    generalise: Generalise = "scenes"
