"""Where the treatments of a study run, and how a run survives whatever happens to it."""
