"""Chapter 3 of the thesis, section by section: flexible rotors, all degrees of freedom measured."""
