"""Data that models learn from are made again when the code that makes them changes."""

from pathlib import Path

import pytest
from faultpath_quadrotor.training.pool import code_of


def test_an_edit_of_any_source_counts_and_compiled_kernels_do_not(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Training data are made without kernels, so they are the same with them."""
    package = tmp_path / "faultpath_yy"
    (package / "deep").mkdir(parents=True)
    for name in ("__init__.py", "deep/one.py"):
        (package / name).touch()
    monkeypatch.syspath_prepend(tmp_path)
    digest = code_of.__wrapped__

    before = digest("faultpath_yy")
    (package / "kernels.so").touch()
    assert digest("faultpath_yy") == before != digest()
    (package / "deep" / "one.py").write_text("# a word")
    assert digest("faultpath_yy") != before
