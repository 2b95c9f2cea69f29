"""The thread that processes all that zenoh and HTTP deliver: inbox, admission, the cycle, doubts about the service's clock.
It imports `write_path`, `recovery`, `replication`, `resilience` and `wire`; batches go to the sample writer, rejected
ones to the quarantine.
"""
