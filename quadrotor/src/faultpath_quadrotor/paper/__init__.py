"""The paper's tables, figures and claims as data, and the runs that they ask for."""
