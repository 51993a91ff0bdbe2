"""What a user chooses of the quadrotor, held to what it is built from."""

from faultpath_quadrotor import choices, models
from faultpath_quadrotor.choices import QuadrotorChoices
from faultpath_quadrotor.options import QuadrotorOptions
from faultpath_quadrotor.planners import SamplerSettings


def test_the_predictors_on_offer_are_those_that_load():
    assert tuple(models.PREDICTORS) == choices.PREDICTORS


def test_the_default_number_of_candidates_is_the_frozen_one():
    assert QuadrotorChoices().candidates == SamplerSettings().candidates


def test_free_space_has_true_clearance_unless_it_is_chosen():
    parse = QuadrotorOptions.parse
    assert parse().clearance == "depth"
    assert parse(environment="free-space").clearance == "true"
    assert parse(environment="free-space", clearance="depth").clearance == "depth"
    assert parse(candidates="1024", wind="L2") == QuadrotorOptions(candidates=1024, wind="L2")
