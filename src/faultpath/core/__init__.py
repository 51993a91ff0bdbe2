"""Parts that all rooms use: errors and their sources, arrays, random streams, readers of files."""

__version__ = "0.4.0"
