"""What a process of the service does: everything, or one part of it beside others on one PostgreSQL database."""

from typing import Literal

Role = Literal["all", "ingest", "identify", "api"]
"""ingest: zenoh and HTTP samples to the store. identify: computes, judges, delivers alerts. api: the REST API and the page."""
