"""The model's tests run on the compiled kernels; `test_backend` holds NumPy against them.

With ``PAMINSA_VIZ_BACKEND=numpy`` they run on NumPy instead.
"""

from __future__ import annotations

import os

import pytest

from paminsa_viz.model import backend


@pytest.fixture(autouse=True, scope="session")
def kernels() -> None:
    """Load the kernels first, or which of the two a test meets would depend on those before it."""
    if os.environ.get("PAMINSA_VIZ_BACKEND") != "numpy":
        backend.compile_now()
