"""Errors of measuring chains and couplings that a document omits: which ones the score of a fit suspects, fits done again with
them, and what estimates they leave. It imports `problem`, `optimisation`, `validation`, `rotor` and `machine`; `fit` tells its
conclusions beside them, and `diagnosis` goes by what they say.
"""
