"""Settings, log format and documents in files: the lowest room. It imports no room of the service but `secrets`; every room
may import it.
"""
