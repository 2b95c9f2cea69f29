"""Stores of which pages are damaged, as by a disk: those that hold a text and nothing else."""

from pathlib import Path

PAGE = 4096


def damage(path: Path, text: bytes) -> None:
    """Spoil one page in the middle of those that hold a text. Nobody may have the file open."""
    held = bytearray(path.read_bytes())
    pages = [number for number in range(len(held) // PAGE) if text in held[number * PAGE : (number + 1) * PAGE]]
    assert len(pages) > 2
    start = pages[len(pages) // 2] * PAGE
    held[start : start + PAGE] = b"\xff" * PAGE
    path.write_bytes(held)
