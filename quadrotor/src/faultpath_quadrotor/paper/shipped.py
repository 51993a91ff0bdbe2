"""The run of the whole paper that comes with the package."""

from pathlib import Path

from faultpath_quadrotor.paper.answers import Ledger, Reproduction

RUN = Path(__file__).parent / "paper" / "run"


def shipped_ledger() -> Ledger:
    """Return what the run answered; a test holds it to what the code answers from its tables."""
    return Reproduction.model_validate_json((RUN / "reproduction.json").read_bytes()).ledger
