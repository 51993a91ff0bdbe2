"""The quadrotor as parts of a closed loop: what a step reads, computes and writes."""
