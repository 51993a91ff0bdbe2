"""Files that a user names: what may be opened, and strict readers of YAML and JSON."""
