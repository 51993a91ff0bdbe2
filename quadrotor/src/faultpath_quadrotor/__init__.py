"""The reference application: a quadrotor that plans with a world model."""
