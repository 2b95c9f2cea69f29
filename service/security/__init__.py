"""Authentication, authorisation, and the audit trail of changes. It imports `http`, `configuration`, `resilience` and
`wording`; its guard stands in front of the API, and what it admits goes on to the API's routes.
"""
