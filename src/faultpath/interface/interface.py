"""An interface whose parts fit each other."""

from typing import Self

from pydantic import model_validator

from faultpath.interface.checks import check_interface
from faultpath.interface.model import Declared


class Interface(Declared):
    """All sources and channels of a system, and which modules produce a source themselves."""

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        check_interface(self)
        return self
