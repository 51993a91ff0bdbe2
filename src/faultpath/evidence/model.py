"""What is measured: flights to record, and a quantity of one variant on their windows."""

import hashlib
import json
from collections.abc import Mapping
from types import MappingProxyType
from typing import Literal, TypeAlias

from pydantic import BaseModel, ConfigDict

Quantity: TypeAlias = Literal[
    "position-error", "position-response", "acceleration-error", "wind-term-error"
]

QUANTITIES: Mapping[Quantity, str] = MappingProxyType(
    {
        "position-error": "m",
        "position-response": "m",
        "acceleration-error": "m/s^2",
        "wind-term-error": "m/s^2",
    }
)
"""Unit of each quantity. `docs/design/evidence.md` gives their formulas."""


class _Frozen(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")


class Recording(_Frozen):
    """Closed-loop flights under correct inputs, whose windows are measured.

    Which scenes of the library fly is said when they are measured: the first N.
    """

    library: str
    """Name of a library, or the path of its file."""
    variant: str
    """Variant that flies."""
    seed: int = 0
    options: dict[str, str] = {}
    """Options of the system, as in `SystemSpec`."""

    @property
    def name(self) -> str:
        """Return a readable name of its own, such as `held-out:true-parameter:0:wind-L3`."""
        parts = [self.library, self.variant, str(self.seed)]
        if self.options:
            parts.append(",".join(f"{key}-{value}" for key, value in sorted(self.options.items())))
        return ":".join(parts)

    def __hash__(self) -> int:
        """Hash by name, since options have no hash."""
        return hash(self.name)


class Measurement(_Frozen):
    """A quantity of one variant on the windows of a recording, window by window."""

    recording: Recording
    quantity: Quantity
    subject: str
    """Variant that is measured: a predictor and what feeds its wind input, as in arms."""
    seed: int = 0
    """Seed of the training of what the variant names, and of the faults' random numbers."""
    faults: tuple[str, ...] = ()
    """Faults as the command line writes them, for example `calibration=+0.1@predictor`."""

    def key(self) -> str:
        """Content hash: equal measurements have equal keys, on every machine."""
        content = json.dumps(self.model_dump(mode="json"), sort_keys=True)
        return hashlib.sha256(content.encode()).hexdigest()[:16]

    def __hash__(self) -> int:
        """Hash by content, as `key`."""
        return hash(self.key())
