"""The paper's claims: what each consists of, and what a run says of it."""

from faultpath_quadrotor.paper.claims.ledger import STATEMENTS, again, evaluate, ledger

__all__ = ["STATEMENTS", "again", "evaluate", "ledger"]
