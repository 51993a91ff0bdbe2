"""What most models of data have in common."""

from pydantic import BaseModel, ConfigDict


class Frozen(BaseModel):
    """Data that nobody changes, and that holds nothing but its fields."""

    model_config = ConfigDict(frozen=True, extra="forbid")
