"""Every intervention that there is: one line each."""

from typing import Annotated, TypeAlias, get_args

from pydantic import Discriminator

from faultpath.faults.base import Intervention
from faultpath.faults.noise import Drift, Noise
from faultpath.faults.probes import Replace, Shuffle
from faultpath.faults.sequence import Sequence
from faultpath.faults.timing import Delay, Dropout, Freeze, Hold
from faultpath.faults.values import Erase, Offset, Quantise, Scale, UniformScale

Listed: TypeAlias = (
    Scale
    | UniformScale
    | Offset
    | Quantise
    | Erase
    | Noise
    | Drift
    | Delay
    | Hold
    | Freeze
    | Dropout
    | Replace
    | Shuffle
    | Sequence
)
AnyIntervention: TypeAlias = Annotated[Listed, Discriminator("kind")]
"""Any intervention, told apart in JSON by its `kind`."""

Sequence.model_rebuild(_types_namespace={"AnyIntervention": AnyIntervention})

INTERVENTIONS: dict[str, type[Intervention]] = {
    intervention.model_fields["kind"].default: intervention for intervention in get_args(Listed)
}
"""By kind."""
