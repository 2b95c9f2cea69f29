"""Repositories of alerts, suppressions, subscriptions and deliveries. They import `tables` and `database`; the service's
alerts and its delivery work on their rows.
"""
