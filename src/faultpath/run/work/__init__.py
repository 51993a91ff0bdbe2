"""Where work runs: a call goes out to a worker, and what it returns comes back."""
