"""Authentication, authorisation and the audit trail: who asks, what they may do and see, and what is recorded of it."""
