"""A run in which the paper's figures come true, and what the claims make of it."""

import pytest
from faultpath_paper.answers import ClaimVerdict
from faultpath_paper.claims import evaluate
from faultpath_paper.results import Results
from study_toys import whole


@pytest.fixture(scope="session")
def published_run() -> Results:
    return whole()


@pytest.fixture(scope="session")
def answers(published_run: Results) -> dict[str, ClaimVerdict]:
    return {claim.id: claim for claim in evaluate(published_run)}
