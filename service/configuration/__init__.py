"""Settings and log format. It imports `secrets`, no other room of the service; every room above may import
it.
"""
