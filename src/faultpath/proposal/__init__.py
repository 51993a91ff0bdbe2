"""What to audit first: uncertain sources ranked, arms proposed, trials and time told in advance."""
