"""The flexible trains of the thesis's Chapters 3 and 4: experiments on them, printed values, misprints."""
