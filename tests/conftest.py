"""How the property tests draw their examples.

``suite`` draws the same examples on every run, so that a failure can be repeated and a pass means
the same everywhere. ``pytest --hypothesis-profile explore`` draws many new ones.
"""

from __future__ import annotations

from hypothesis import HealthCheck, settings

_SLOW = [HealthCheck.too_slow, HealthCheck.data_too_large]

settings.register_profile(
    "suite",
    deadline=None,
    derandomize=True,
    database=None,
    max_examples=15,
    suppress_health_check=_SLOW,
)
settings.register_profile(
    "explore", deadline=None, max_examples=400, print_blob=True, suppress_health_check=_SLOW
)
settings.load_profile("suite")
