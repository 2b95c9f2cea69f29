"""What holds for all resources: dependencies of endpoints, errors, paging, preconditions, units, times. It imports no
resource; every resource imports it.
"""
