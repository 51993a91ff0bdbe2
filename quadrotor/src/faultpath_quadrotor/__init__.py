"""The reference application: a quadrotor that plans with a world model."""

from faultpath_quadrotor import instructions

instructions.fix()
