"""Stored runs on other people's packages repeat too: to the bit, or as nearly as their page says."""

import sys
from pathlib import Path

import pytest
from foreign_trials import ROOT

sys.path.append(str(ROOT / "tools"))
import blocks
import repeats

PACKAGES = {
    "basilisk": "Basilisk",
    "do-mpc": "do_mpc",
    "rotorpy": "rotorpy",
    "motulator": "motulator",
}
"""By stored run, the package that its example needs."""


@pytest.mark.parametrize("name", PACKAGES)
def test_a_sample_of_a_run_comes_out_as_its_page_says(name: str) -> None:
    pytest.importorskip(PACKAGES[name])
    run = blocks.load(name)
    assert run.repeats is not None, f"ask it first: tools/{Path(repeats.__file__).name}"
    result = repeats.repeat(run)
    assert result.current is run.repeats.current
    assert result.near >= run.repeats.repeated
