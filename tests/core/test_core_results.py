"""Classes of results hold their declared fields and no others."""

import pytest

from faultpath.core.results import Frozen


class Made(Frozen):
    value: int = 0


def test_a_copy_gets_no_field_that_is_not_declared() -> None:
    assert Made().model_copy(update={"value": 1}) == Made(value=1)
    with pytest.raises(TypeError, match="Made has no field 'valve'"):
        Made().model_copy(update={"valve": 1})
