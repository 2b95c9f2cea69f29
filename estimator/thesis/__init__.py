"""Published methods of M. Lal's thesis (IIT Guwahati): regressions on responses, beside the maximum-likelihood fit."""
