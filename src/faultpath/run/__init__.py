"""Treatments run over identical scenes: plans, workers, the store, trials and their pairing."""
