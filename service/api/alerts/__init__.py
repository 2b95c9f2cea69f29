"""Alerts, suppressions, subscriptions and the stream of events. It imports `conventions`, `cache`, `security`, `advice`,
`alerts`, `delivery`, `reports`, `secrets`, `resilience`, `wording`, `findings` for the evidence, and `monitoring/rules` for
what a suppression may name; what people do to an alert becomes an event in the store, from which `delivery` and the stream
take it.
"""
