"""Sample blocks and text as they are stored. It imports no other room but the estimator's data types; repositories encode and
decode by it.
"""
