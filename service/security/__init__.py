"""Authentication, authorisation, and the audit trail of changes. It imports `http`, `configuration`, `resilience` and
`secrets`; its guard stands in front of the API.
"""
