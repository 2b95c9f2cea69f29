"""HTTP without knowledge of the API: server, ASGI middleware, problem details, the status of each category of errors. It
imports `configuration`, `resilience` and `secrets`; `security` and `api` use it.
"""
