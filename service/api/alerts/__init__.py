"""Alerts, suppressions, subscriptions and the stream of events. It imports `conventions`, `cache`, `alerts`, `delivery`, and
`findings` for the evidence.
"""
