"""What the tests of the quadrotor share."""

from collections.abc import Iterator

import pytest
import torch
from faultpath_quadrotor import native
from flights import STEPS

torch.set_num_threads(1)


@pytest.fixture(params=native.available())
def isa(request: pytest.FixtureRequest) -> str:
    """Each set of kernels that was compiled."""
    return request.param


@pytest.fixture(scope="module")
def short(request: pytest.FixtureRequest) -> Iterator[None]:
    """Let flights last as many control steps as the module says, or as `flights` does."""
    steps = getattr(request.module, "STEPS", STEPS)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("faultpath_quadrotor.plant.module.CONTROL_STEPS", steps)
        yield
