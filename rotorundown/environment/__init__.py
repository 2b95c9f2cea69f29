"""The Python that the library runs in: its release, its own packages and example machines, optional packages, notebooks, and
the threads of BLAS. It imports no other room; the library, its plots and the service ask it.
"""
