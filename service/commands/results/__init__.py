"""Results of commands as text for a terminal, and as contents for JSON. It imports no other room of the service; the commands
print what it returns.
"""
