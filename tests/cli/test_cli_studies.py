"""`reproduce`: mistakes end in a sentence, and the shipped run answers at once."""

import json
from pathlib import Path

import pytest
from cli_runs import faultpath
from faultpath_paper.cells import published_claims

MISTAKES = {
    "no such page": (["reproduce", "table-9"], ["no page 'table-9'", "table-1, table-2"]),
    "no such profile": (["reproduce", "--profile", "huge"], ["'huge'", "quick, paper"]),
    "no such device": (
        ["reproduce", "table-4", "--device", "tpu"],
        ["unknown device 'tpu'", "cpu, cuda"],
    ),
    "workers": (["reproduce", "table-4", "--workers", "-1"], ["-1", "0 (this process) or more"]),
    "no run": (
        ["reproduce", "--judge", "--out", "nowhere"],
        ["nowhere holds no finished reproduction"],
    ),
}


@pytest.mark.parametrize(("line", "says"), MISTAKES.values(), ids=MISTAKES)
def test_a_mistake_is_one_sentence(
    line: list[str], says: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    said = faultpath(*line).refused()
    assert all(words in said for words in says), said


def test_the_shipped_claims_are_json() -> None:
    done = faultpath("reproduce", "--judge", "--json")
    assert done.status == 0, done.err
    claims = json.loads(done.out)
    assert [claim["id"] for claim in claims] == [claim.id for claim in published_claims()]
    wanted = {"id", "kind", "verdict", "estimate", "interval", "mde", "paper"}
    assert all(wanted <= set(claim) for claim in claims)
    assert {claim["verdict"] for claim in claims} <= {"confirmed", "refuted", "undecided"}
