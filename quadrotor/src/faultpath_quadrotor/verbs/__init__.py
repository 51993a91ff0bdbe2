"""The verbs that the quadrotor adds to the command line."""
