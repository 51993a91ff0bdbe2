"""Documents say by which code a reference run was flown, and whether that has changed since."""

import sys
from pathlib import Path

import flown_code
import pytest

from faultpath.core.errors import UserError
from faultpath.trials import SystemSpec, load_system
from faultpath.trials.provenance import RunProvenance

ROOT = Path(__file__).resolve().parents[2]
TOY = "examples/toy.py:create"


@pytest.fixture(scope="module")
def made() -> RunProvenance:
    stored = ROOT / "docs" / "reference" / "toy" / "provenance.json"
    here = flown_code._state(TOY, ())
    assert "toy.py" in here.files
    assert any(name.startswith("faultpath/loop/taps") for name in here.files)
    return RunProvenance.model_validate_json(stored.read_bytes()).model_copy(
        update={
            "commit": "0123456789abcdef",
            "dirty": False,
            "blocks_kept": 0,
            "sources": here.files,
            "data": here.data,
        }
    )


def test_a_run_by_the_code_that_is_here_says_so(made: RunProvenance) -> None:
    said = flown_code.flown_by(made, TOY, {})
    assert said == "Run at commit `0123456789ab`; its code has not changed since."
    assert not flown_code.changed(made, TOY, {})


def other(digests: dict[str, str]) -> dict[str, str]:
    return digests | {min(digests): "0" * 64}


@pytest.mark.parametrize(
    ("change", "says", "changed"),
    [
        (lambda made: {"sources": other(made.sources)}, "; its code changed since.", True),
        (lambda made: {"sources": made.sources | {"absent/a.py": "0"}}, "its code has not", False),
        (lambda made: {"data": {"a": "0"}}, "; its code or weights changed since.", True),
        (lambda made: {"sources": {}}, "before runs kept digests of their code", True),
    ],
)
def test_what_else_is_to_be_known_is_said(made, change, says: str, changed: bool) -> None:
    run = made.model_copy(update=change(made))
    assert says in flown_code.flown_by(run, TOY, {})
    assert flown_code.changed(run, TOY, {}) == changed


def test_what_flies_is_known_without_its_package(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    place = "examples/pendulum.py:create"
    with_it = flown_code._state(place, ())
    flown_code._state.cache_clear()
    monkeypatch.setitem(sys.modules, "gymnasium", None)
    monkeypatch.delitem(sys.modules, "faultpath.systems.gymnasium")
    with pytest.raises(UserError, match="gymnasium"):
        load_system(SystemSpec(name=str(ROOT / place)))
    assert flown_code._state(place, ()).files == with_it.files
