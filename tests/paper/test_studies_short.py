"""The ledger in short leaves no claim and no figure out."""

import re

import pytest
from faultpath_quadrotor.paper.answers import Ledger, shipped_ledger
from faultpath_quadrotor.paper.cells import published_claims
from faultpath_quadrotor.paper.claims import SUBJECTS
from faultpath_quadrotor.paper.report.short import apart, by_kind, by_subject


@pytest.fixture(scope="module")
def ledger() -> Ledger:
    return shipped_ledger()


def test_every_claim_stands_once_under_its_kind_and_answer(ledger: Ledger) -> None:
    lines = by_kind(ledger).lines
    told = [name for each in lines for e in each.entries for name in re.findall(r"C\d\d", e.text)]
    assert sorted(told) == [claim.id for claim in ledger.claims]


def test_every_claim_has_one_subject_and_its_figures_add_up(ledger: Ledger) -> None:
    every = [claim for claims in SUBJECTS.values() for claim in claims]
    assert sorted(every) == [claim.id for claim in published_claims()]
    *subjects, last = (
        [int(entry.text) for entry in each.entries] for each in by_subject(ledger).lines
    )
    assert [sum(column) for column in zip(*subjects, strict=True)] == last
    assert last[0] >= sum(last[1:]) > 0


def test_what_did_not_come_out_is_told_by_the_part_that_decides(ledger: Ledger) -> None:
    told = dict(apart(ledger))
    assert [name[:3] for name in told] == [c.id for c in ledger.claims if c.verdict != "confirmed"]
    assert all(":" in said for said in told.values())
