"""The paper's claims: what each consists of, and what a run says of it."""

from faultpath.studies.claims.ledger import STATEMENTS, again, evaluate, ledger

__all__ = ["STATEMENTS", "again", "evaluate", "ledger"]
