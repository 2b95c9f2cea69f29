"""Examines a deployment from outside: settings, database, certificates, and endpoints open to strangers. It imports
`configuration`, `messaging`, `mqtt`, `security`, `maintenance`, `delivery`, `wire` and `api`, whose operations it probes;
`commands` prints its results.
"""
