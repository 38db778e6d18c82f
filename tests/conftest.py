"""Loads what the tests share."""

import os

# Every core has a worker: threads of BLAS would wait for each other, and take five times as long
# for the small matrices here. Read when NumPy is loaded, by the workers and by what tests start.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

pytest_plugins = ["tests.support.plugin", "tests.support.page"]
