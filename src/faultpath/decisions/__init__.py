"""The decision: effects, break-even frequency, verdict."""
