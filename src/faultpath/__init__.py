"""Audit whether a repair still helps when a fault reaches every module that shares its source."""

__version__ = "0.1.0"
