"""Chapter 4 of the thesis, section by section: flexible rotors, bearings and couplings measured."""
