"""A tank with a level sensor, to audit with faultpath."""
