"""The Python that the library runs in: its own packages beside it, optional ones, and the threads of BLAS. It imports no other
room; the library and its plots ask it.
"""
