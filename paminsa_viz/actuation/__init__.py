"""Forces and drives: what the platform can push, carry and reach in speed, and which motors do it.

`wrench_capability` and `transmission` measure a pose; the drives of a design give the limits.
"""
