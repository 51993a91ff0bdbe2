"""Which declared uncertainty moves what a variant achieves: design, indices, record."""
