"""Side-by-side measurements of faultpath and of other software that does the same work."""
