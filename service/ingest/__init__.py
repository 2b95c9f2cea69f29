"""The thread that processes all that zenoh and HTTP deliver: inbox, admission, the cycle, doubts about the service's clock. It
imports `journal`, `recovery`, `runs` and the rooms below; batches go to the journal, rejected ones to the quarantine."""
