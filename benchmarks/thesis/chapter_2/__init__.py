"""Chapter 2 of the thesis, section by section: two rigid rotors."""
