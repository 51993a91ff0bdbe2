"""What a careful reviewer runs on a system: checks of what it promises, traces of its reads."""
