"""Settings, log format and documents in files: the ground floor. It imports no room of the service but `secrets`; every room
may import it.
"""
