"""Outcome arrays in, estimates and intervals out; no plots and no files."""
