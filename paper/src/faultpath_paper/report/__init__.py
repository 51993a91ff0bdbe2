"""A reproduction of the paper: one HTML page, the ledger in the terminal and as Markdown."""
