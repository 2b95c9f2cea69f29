"""Every `rundown …` command. It may import every room; nothing imports it but `__main__`."""
