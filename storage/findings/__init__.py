"""Repositories of jobs, identifications, derived quantities, diagnoses and trends. They import `tables`, `database`,
`encoding`, `machines` and `measurements`; the service's identification and monitoring store their results here.
"""
