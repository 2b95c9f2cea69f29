"""Conventions of all resources: dependencies, errors, paging, preconditions, units, times. It imports `http`, `security`,
`secrets`, `identification` and `wording`, and no resource; every resource imports it.
"""
