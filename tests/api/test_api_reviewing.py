"""`check` from Python, of a name and of an object."""

import pytest
from toy_audits import FILE

import faultpath
from faultpath import check

ASKED = {"library": "carts", "scenes": 2, "workers": 0, "progress": False}


def test_a_check_of_an_object_is_that_of_its_name():
    report = check(FILE, variants=["blind"], **ASKED)
    assert report.failures == ()
    assert report.variants == ("blind",)

    class Own(type(faultpath.load_system(FILE))):
        pass

    own = check(Own(), variants=["blind"], **ASKED)
    assert [each.status for each in own.checks] == [each.status for each in report.checks]
    with pytest.raises(faultpath.UserError, match="an object cannot be sent to worker processes"):
        check(Own(), workers=2)
