"""One more finding, delivery channel, bearing model and resource: what a developer would write to add each.

A module per kind of addition; each is written into a copy of the packages, never into the tree. The texts come from here;
`tests.test_places_to_touch` counts the files that they take and runs the copy with all of them.
"""
