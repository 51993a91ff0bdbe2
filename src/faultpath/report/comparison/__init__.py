"""Several finished audits side by side: what differs between them, and what each has decided.

Nothing is decided here. Every audit keeps its own verdict, and no number is of two audits together.
"""
