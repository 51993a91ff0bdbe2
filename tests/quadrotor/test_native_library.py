"""Which kernels run, and what is said about it."""

import pytest
from faultpath_quadrotor import native
from faultpath_quadrotor.native import library
from kernel_sets import FUSED

from faultpath.core.errors import UserError


def test_the_fastest_set_runs_unless_another_is_asked_for(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv(library.VARIABLE, raising=False)
    built = native.kernels()
    assert built is not None
    assert built.isa == native.available()[0]
    here = native.describe()
    assert native.numerics() in here
    for isa in FUSED:
        monkeypatch.setenv(library.VARIABLE, isa)
        assert native.describe() == here
    monkeypatch.setenv(library.VARIABLE, "portable")
    assert native.kernels() is None
    assert native.numerics() == "portable"
    assert library.VARIABLE in native.describe()
    monkeypatch.setenv(library.VARIABLE, "fast")
    with pytest.raises(UserError, match="is 'fast': it takes one of auto, avx512"):
        native.kernels()


def test_without_built_kernels_the_portable_path_runs_and_says_why(monkeypatch, tmp_path):
    monkeypatch.delenv(library.VARIABLE, raising=False)
    monkeypatch.setattr(library, "_path", lambda isa: tmp_path / isa)
    library._chosen.cache_clear()
    assert native.kernels() is None
    assert "no C++ compiler" in native.describe()
    library._chosen.cache_clear()


def test_kernels_of_other_sources_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(library, "_sources", lambda: "another digest")
    with pytest.raises(UserError, match=r"other sources .* make setup"):
        native.load("baseline")
