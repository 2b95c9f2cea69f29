"""The thesis's numerical experiments run again: what reproduces, what does not, what maximum likelihood reaches."""
