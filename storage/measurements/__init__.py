"""Repositories of sample blocks, sources, runs and the quarantine. They import `tables` and `encoding`; the sample
writer writes through them and workers read."""
