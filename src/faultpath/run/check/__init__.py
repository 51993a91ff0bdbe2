"""Checks of a system's promises and traces of its reads, as a careful reviewer runs them."""
