"""Settings and log format. It imports `secrets`, no other room of the service; settings come from the environment and a
file, and every room above reads them here.
"""
