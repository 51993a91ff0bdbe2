"""Stored runs on other people's packages repeat: to the bit, or as nearly as their page says."""

import sys
from importlib.util import find_spec

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
    "wpilib": "wpimath",
    "openpilot-ford": "opendbc",
    "openpilot-tesla": "opendbc",
    "openpilot-nissan": "opendbc",
    "openpilot-nissan-tolerance": "opendbc",
    "stable-worldmodel-augmented-moved": "stable_worldmodel",
    "stable-worldmodel-rectified-darker": "stable_worldmodel",
}
"""By stored run, the package that its example needs."""


@pytest.mark.parametrize("name", PACKAGES)
def test_a_sample_of_a_run_comes_out_as_its_page_says(name: str) -> None:
    if find_spec(PACKAGES[name]) is None:  # some are imported by their example, which knows how
        pytest.skip(f"{PACKAGES[name]} is not installed")
    run = blocks.load(name)
    result = repeats.repeat(run)
    assert result.sampled > 0
    assert result.near >= 0.75 * result.sampled, result.first
