"""Documents say by which code a reference run was flown, and whether that has changed since."""

import re
import sys
from pathlib import Path

import pytest

from faultpath.record import RunProvenance

ROOT = Path(__file__).resolve().parents[2]
TOY = "examples/toy.py:create"


@pytest.fixture(scope="module")
def flown_code():
    sys.path.insert(0, str(ROOT / "tools"))
    try:
        import flown_code
    finally:
        sys.path.remove(str(ROOT / "tools"))
    return flown_code


@pytest.fixture(scope="module")
def made(flown_code) -> RunProvenance:
    """A run of the toy by the code that is here."""
    stored = ROOT / "docs" / "reference" / "toy" / "provenance.json"
    here = flown_code._state(TOY, ())
    assert "toy.py" in here.files
    assert any(name.startswith("faultpath/taps") for name in here.files)
    return RunProvenance.model_validate_json(stored.read_bytes()).model_copy(
        update={
            "commit": "0123456789abcdef",
            "dirty": False,
            "blocks_kept": 0,
            "sources": here.files,
            "data": here.data,
        }
    )


def test_a_run_by_the_code_that_is_here_says_so(flown_code, made: RunProvenance) -> None:
    said = flown_code.flown_by(made, TOY, {})
    assert said == "Flown by commit `0123456789ab`; nothing that flew has changed since."


def other(digests: dict[str, str]) -> dict[str, str]:
    return digests | {min(digests): "0" * 64}


def fewer(digests: dict[str, str]) -> dict[str, str]:
    return {name: digest for name, digest in digests.items() if name != min(digests)}


@pytest.mark.parametrize(
    ("change", "says"),
    [
        (lambda made: {"sources": other(made.sources)}, "; code that flew changed since."),
        (lambda made: {"sources": fewer(made.sources)}, "; code that flew changed since."),
        (lambda made: {"data": {"a": "0"}}, "; code or weights that flew changed since."),
        (lambda made: {"sources": {}}, "before runs kept digests of what flies: by older code"),
        (lambda made: {"dirty": True}, "with uncommitted changes; nothing that flew has changed"),
        (lambda made: {"commit": None}, "Flown by code of no known commit; nothing"),
        (lambda made: {"blocks_kept": 3}, "Finished by commit"),
    ],
)
def test_what_else_is_to_be_known_is_said(
    flown_code, made: RunProvenance, change, says: str
) -> None:
    assert says in flown_code.flown_by(made.model_copy(update=change(made)), TOY, {})


BLOCK = re.compile(r"<!-- begin:(?:table|terminal|times|origin):\S+ -->\n(.*?)<!-- end:", re.DOTALL)


def test_what_documents_show_of_a_reference_run_says_by_which_code_it_flew() -> None:
    """Its words are made by `make docs`, and `--check`, which a test runs, makes them again."""
    pages = (ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md")))
    shown = [body for page in pages for body in BLOCK.findall(page.read_text("utf-8"))]
    flown = [body for body in shown if body.strip() and "has not been made yet" not in body]
    assert len(flown) > 3
    assert all(" by commit `" in body for body in flown)
