"""Numbers with intervals that a run gives: tables print them, and claims are decided by them."""
