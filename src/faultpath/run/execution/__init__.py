"""Where the treatments of a plan run, and how a run survives whatever happens to it."""
