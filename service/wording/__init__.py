"""Findings in words, English and German: templates with places, and the numbers that stand in them. It imports no other room;
`monitoring` declares each finding's own texts with them.
"""
