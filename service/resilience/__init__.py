"""Backoff, rate limits, bounded memory, supervised threads and internal errors: what every part of the service needs to go on
after a fault. Errors come in from all rooms; what was rejected goes out to the store's quarantine, and to logs and health. It
imports `wire` for the reasons of rejections.
"""
