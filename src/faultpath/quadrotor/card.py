"""What a fitted model says of itself, in a file beside its weights; read without torch."""

from pathlib import Path

from pydantic import JsonValue

from faultpath.errors import UserError
from faultpath.files.opening import contents
from faultpath.files.plain import Misread, model_of
from faultpath.frozen import Frozen

FORMAT = "faultpath-model/1"


class ModelCard(Frozen):
    """Where the weights of one model come from and how good they are.

    It is `<stem>.json` beside `<stem>.safetensors`. Only `weights_sha256` identifies the model:
    durations and versions differ between fits that gave the same weights.
    """

    format: str = FORMAT
    name: str
    seed: int
    description: str
    parameters: int
    """Numbers that were fitted; constants such as the scales of the inputs do not count."""
    samples: int
    """Training samples in an epoch."""
    schedule: dict[str, JsonValue]
    data_sha256: dict[str, JsonValue]
    """Digest of each pool of data."""
    config: dict[str, JsonValue]
    """Everything else the task says of itself."""
    order_key: str
    """Stream of the minibatch order."""
    initial_sha256: str
    """Digest of the model before its first step."""
    first_loss: float
    """Loss of the first minibatch before the first step."""
    training_loss: tuple[float, ...]
    """Mean over the minibatches of each epoch."""
    validation: tuple[dict[str, float], ...]
    """Metrics after each epoch."""
    weights_sha256: str
    """Digest of the weights file."""
    duration_s: float
    """Time spent in epochs, all processes together."""
    platform: str
    """`Platform.weights_hash`: what decided the data, as far as a platform does."""
    torch_version: str
    faultpath_version: str

    @property
    def stem(self) -> str:
        """Name of the files without their ending."""
        return stem(self.name, self.seed)

    @property
    def final(self) -> dict[str, float]:
        """Validation metrics of the weights, the main one first."""
        return self.validation[-1]


def stem(name: str, seed: int) -> str:
    """Return the file name of a model without its ending, for example `wm-a+dcc-0`."""
    return f"{name}-{seed}"


def read_card(path: Path) -> ModelCard:
    """Read the card beside a weights file; `UserError` when it is missing or damaged."""
    card = path.with_suffix(".json")
    try:
        return model_of(contents(card), ModelCard)
    except (OSError, Misread) as error:
        reason = error.strerror if isinstance(error, OSError) else "it is no model card"
        raise UserError(
            f"cannot read the model card {card} ({reason}): copy it again or fit the model again."
        ) from error
