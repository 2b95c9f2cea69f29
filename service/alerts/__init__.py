"""The life of an alert after ISA-18.2, its transitions in the database, and the message of each event. It imports no other
room; `delivery`, `mqtt`, `opcua` and the API publish its events.
"""
