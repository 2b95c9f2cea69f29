"""Conventions of all resources: dependencies, errors, paging, preconditions, units, times. It imports `http`, `security`,
`secrets`, `export`, `identification` and `wording`, and no resource; every resource imports it.
"""
