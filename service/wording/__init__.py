"""Findings in words, English and German: templates with places, and the numbers that stand in them. Kinds and numbers of
alerts come in, sentences go out to API, page, report and messages. It imports no other room; `monitoring` declares each
finding's own texts with them.
"""
