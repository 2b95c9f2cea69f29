"""Backoff, rate limits, bounded memory and internal errors: means without knowledge of machines. It imports `wire` for the
words of rejections.
"""
