"""Repositories of jobs, identifications, derived quantities, diagnoses and trends. They import `tables`, `encoding` and
`measurements`; the service's `identification` and `monitoring` file what they found here.
"""
