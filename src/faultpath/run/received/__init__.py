"""Trials that other tools ran: what is asked of their results, and how their files are read."""
