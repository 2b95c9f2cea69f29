"""Chapter 5 of the thesis, section by section: its test rig."""
