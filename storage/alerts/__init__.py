"""Repositories of alerts, suppressions, subscriptions and deliveries. They import `tables`, `database` and `encoding`; the
service's `alerts` and `delivery` work on their rows.
"""
