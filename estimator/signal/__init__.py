"""Waveforms and a keyphasor's pulses to 1× and 2× phasors with their scatter, as the edge agent needs them. It imports no
other room; its phasors go over the wire and come back as `phasors`.
"""
