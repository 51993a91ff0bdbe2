"""Questions as records keep them, and the rule by which an audit is answered."""

from typing import Literal, TypeVar

from pydantic import Field

from faultpath.core.results import Frozen, Result
from faultpath.faults import Fault
from faultpath.run import SystemSpec
from faultpath.run.question import Asked, Generalise, StopWhen
from faultpath.stats.estimate import TESTS
from faultpath.system.declared import Library
from faultpath.system.outcome import VEHICLE, Metric, MetricName

_Model = TypeVar("_Model", bound=Frozen)


class Resolved(Result):
    """A question as its record keeps it: as asked, with what system and library say of it."""

    system: str
    options: dict[str, str]


def resolve(
    model: type[_Model], question: Asked, system: SystemSpec, library: Library, **more: object
) -> _Model:
    """Return a question as `model` keeps it; `more` adds to what is asked or takes its place."""
    fields = {
        **vars(question),
        "system": system.name,
        "options": system.options,
        "library": library.name,
        "library_hash": library.content_hash,
        **more,
    }
    kept = model.model_fields
    return model.model_validate({name: fields[name] for name in fields if name in kept})


class StopRule(Result):
    """When a sequential audit stops."""

    when: StopWhen
    """`decided`: the primary contrast is; `all-decided`: the effect under every condition is."""
    margin_pp: float | None = None
    """A difference that is shown to be smaller than this counts as decided too."""
    order: tuple[str, ...]
    """The scenes in the order in which they are run, drawn before the first trial."""
    order_seed: int
    """Seed of the draw, with the hash of the library."""
    look: int
    """Scenes from one look at the results to the next."""
    trials: int
    """That a scene takes: distinct treatments."""


class JudgedTrials(Result):
    """Facts about trials that other tools ran."""

    pairing: Literal["keys", "hashes"]
    """`hashes`: the two trials of a pair agree in a hash of what they began with."""
    unit: Literal["scene", "task"] = "scene"
    """Unit that counts as one scene: a scene, or a task with all of its scenes."""


class Question(Resolved):
    """Question of an audit, as its record keeps it."""

    baseline: str
    repair: str
    fault: str
    """The fault in words, as given on the command line."""
    faults: tuple[Fault, ...] = ()
    """The same spelled out, channel by channel, at every reader that it names; empty in records
    that do not say."""
    library: str
    library_hash: str
    n_scenes: int
    seeds: tuple[int, ...]
    primary: str = ""
    """Condition of the primary contrast, which leads the headline; empty for the default."""
    generalise: Generalise = "scenes"
    """Population that intervals and tests hold for: new scenes, or newly trained models too."""
    trained: bool = False
    """Whether the variants hold trained models."""
    ends: dict[str, str] = Field(default_factory=dict)
    """Names that the system has for its ends, where they are not the status itself."""
    metrics: dict[MetricName, Metric] = VEHICLE
    """Metrics of its trials. Records that name none are of a vehicle."""
    metric: str = ""
    """The metric to tell beside success; empty for none."""
    thresholds: tuple[float, ...] = ()
    """Thresholds of that metric at which success is counted anew."""
    stop: StopRule | None = None
    """Rule of a sequential audit, of which `n_scenes` is the most that it takes."""
    judged: JudgedTrials | None = None
    """Facts about results that other tools wrote."""

    @property
    def family(self) -> str:
        """How p-values were adjusted, as part of a sentence."""
        return "after Holm" if self.stop is None else "within the family"

    @property
    def tests(self) -> str:
        """How effects are tested and adjusted, in words; empty for a sequential audit."""
        return "" if self.stop else TESTS


class EarlierLook(Result):
    """Question of an earlier conclusion of the audit; a record cannot allow for that."""

    scenes: int | None
    """`None` of a sequential audit, which allows for its number."""
    primary: str
    generalise: str = "scenes"
