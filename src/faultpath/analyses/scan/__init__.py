"""The scan: which errors of the inputs of a system cancel each other."""
