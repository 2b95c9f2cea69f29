"""Alerts, suppressions, subscriptions and the stream of events. It imports `conventions`, `cache`, `security`, `advice`,
`alerts`, `delivery`, `reports`, `secrets`, `resilience`, `wording`, and `findings` for the evidence; what people
do to an alert becomes an event in the store, from which `delivery` and the stream take it.
"""
