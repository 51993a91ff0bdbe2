"""The order in which uncertain sources are audited: ranks, and probes that break ties."""
