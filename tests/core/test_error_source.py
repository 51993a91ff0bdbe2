"""Whose an error is, where a distribution carries faultpath's name."""

import sys

import pyarrow as pa
import pytest

from faultpath.core.error_source import explained, location
from faultpath.core.trees import ours


def test_a_distribution_that_carries_our_name_answers_for_its_own_mistakes(tmp_path, monkeypatch):
    (tmp_path / "site-packages" / "faultpath_zz").mkdir(parents=True)
    (tmp_path / "site-packages" / "faultpath_zz" / "__init__.py").write_text(
        "def f(): return [][0]"
    )
    (tmp_path / "mine_zz.py").write_text("def g(): return [][0]")
    monkeypatch.setattr(sys, "path", [*sys.path, str(tmp_path), str(tmp_path / "site-packages")])
    import faultpath_zz
    import mine_zz

    places = []
    for fails in (faultpath_zz.f, mine_zz.g):
        with pytest.raises(IndexError) as error:
            fails()
        error.value.__traceback__ = error.value.__traceback__.tb_next  # without this test's own
        places.append(location(error.value))
    assert places[0] == ""
    assert places[1].endswith("mine_zz.py, line 1")
    assert ours("faultpath_zz")
    assert not ours("faultpath_system_mine_12ab34cd")


def test_what_a_package_compiled_from_cython_is_nobodys_system():
    """Its frames name a file that is relative, and nowhere."""
    with pytest.raises(KeyError) as error:
        pa.table({"a": [1]}).column("b")
    error.value.__traceback__ = error.value.__traceback__.tb_next
    assert location(error.value) == ""


def test_what_a_system_raises_in_a_generator_of_ours_is_its_own(tmp_path, monkeypatch):
    """Python makes another error of StopIteration there."""
    (tmp_path / "stops_zz.py").write_text("def f(): return next(iter(()))")
    monkeypatch.setattr(sys, "path", [*sys.path, str(tmp_path)])
    import stops_zz

    def generator():
        yield stops_zz.f()

    with pytest.raises(RuntimeError) as error:
        next(generator())
    mistake = explained(error.value)
    assert mistake is not None
    assert mistake.location.endswith("stops_zz.py, line 1")
    assert "StopIteration" in str(mistake)
