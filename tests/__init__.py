"""Tests. A package, so that pytest puts the project's folder on the path and not this one, with its folders of equal names."""

import os

# As the commands do, before numpy is loaded: the matrices are small, and more threads wait for one another.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
