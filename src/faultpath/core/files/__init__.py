"""Files that somebody names: what may be opened, and the strict readers of YAML and JSON."""
