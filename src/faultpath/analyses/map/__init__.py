"""The reversal map: two errors of one source, each at a module of its own."""
