"""Trials that other tools ran: the question about them, and how their files are read."""
