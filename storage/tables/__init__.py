"""The tables of the store. Times are nanoseconds since 1970 in UTC; physical values are SI.

Rows are imported from their own modules, each of which is named here. It imports no other room; repositories read and write
through it, and the migrations are compared with it.
"""

from storage.tables import alerting, findings, machines, measurements, operation

__all__ = ["alerting", "findings", "machines", "measurements", "operation"]
