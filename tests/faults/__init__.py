"""Tests of what goes wrong between a probe and the store, with real processes: nothing may be lost and nothing may come
twice."""
