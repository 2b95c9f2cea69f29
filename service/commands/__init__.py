"""Every `rundown …` command. It may import every room, and nothing imports it but `service/__main__.py`; arguments come from
the shell, and answers go to the terminal or to files.
"""
