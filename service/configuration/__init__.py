"""Settings, log format and documents in files. It imports `secrets`, no other room of the service; every room above may import
it.
"""
