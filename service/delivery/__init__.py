"""Alert events from the outbox to webhooks, mail, Alertmanager and zenoh. It imports `advice`, `alerts`, `configuration`,
`rules`, `replication`, `resilience`, `secrets` and `wording`; what was delivered and what was not goes back to the store.
"""
