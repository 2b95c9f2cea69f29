"""The OPC UA server (OPC 10000): machines as objects, findings as conditions, trends as history, each client in its plants.

All is read from the store for clients, whose acknowledgements go back through `alerts`. `serving.py` is the thread,
all that the service imports; it loads the library `asyncua` where a server is configured. It imports `advice`, `alerts`,
`configuration`, `resilience`, `runs` and `security`.
"""
