"""The front door: what `import faultpath` offers, and what the command line calls.

A call runs, decides, writes a run folder and returns what came out. It leaves threads, environment
and random state of its caller as they were.
"""
