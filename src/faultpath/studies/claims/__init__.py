"""The paper's claims: what each consists of, and what a run says of it."""

from faultpath.studies.claims.ledger import LIMITS, STATEMENTS, TOPICS, again, evaluate, ledger

__all__ = ["LIMITS", "STATEMENTS", "TOPICS", "again", "evaluate", "ledger"]
