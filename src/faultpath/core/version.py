"""The version, where no other module has to be loaded for it."""

__version__ = "0.3.0"
