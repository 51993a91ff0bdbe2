"""Plans of what to audit first: uncertain sources ranked, and arms proposed."""
