"""Checks of a parsed machine document: its size and what computing with it costs, values that only a slip of the unit
explains, and warnings of what is probably a mistake. It imports `machine` and `bearings`; they run where documents enter, and
fits take the bounds of its size from here.
"""
