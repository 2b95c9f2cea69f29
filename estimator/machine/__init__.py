"""The machine document: parts, rules, consistency, and what the names of its parameters say. It imports `bearings` only
and knows no rotor dynamics; every other room is given a parsed document.
"""
