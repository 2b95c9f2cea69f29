"""Alert events from the outbox to webhooks, mail, Alertmanager and zenoh. It imports `alerts`, `configuration`, `replication`
and `secrets`.
"""
