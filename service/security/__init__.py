"""Who asks, what they may do and see, and the audit trail of it. It imports `http`, `configuration`, `resilience` and
`secrets`; its guard stands in front of the API.
"""
