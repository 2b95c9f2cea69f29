"""Backoff, rate limits, bounded memory and internal errors: means that know nothing of machines. They import `wire` for the
reasons of rejections."""
