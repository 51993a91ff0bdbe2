"""`check` and `trace` from Python find what the commands find."""

import json

import pytest
from cli_runs import faultpath as command
from toy_audits import FILE, TOY

import faultpath
from faultpath import check

ASKED = {"library": "carts", "scenes": 2, "workers": 0, "progress": False}


def test_a_check_of_a_name_and_of_an_object_is_that_of_the_command():
    report = check(FILE, variants=["blind"], **ASKED)
    assert report.failures == ()
    assert report.variants == ("blind",)
    line = ["check", TOY, "--variants", "blind", "--library", "carts"]
    said = command(*line, "--scenes", "2", "--workers", "0", "--json")
    assert json.loads(said.out) == report.model_dump(mode="json")

    class Own(type(faultpath.load_system(FILE))):
        pass

    own = check(Own(), variants=["blind"], **ASKED)
    assert [each.status for each in own.checks] == [each.status for each in report.checks]
    with pytest.raises(faultpath.UserError, match="an object cannot be sent to worker processes"):
        check(Own(), workers=2)
