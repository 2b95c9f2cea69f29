"""The thread that takes what zenoh and HTTP deliver: inbox, admission, the cycle, the service's own clock. It imports
`journal`, `recovery`, `runs` and what lies below; batches go to the journal, refused ones to the quarantine.
"""
