"""What to audit first: uncertain sources ranked, and arms proposed."""
