"""Sentences on what was decided: a headline, three answers, and what is said of each contrast."""
