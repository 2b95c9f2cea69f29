"""Reads what is drawn on the page, whether it is seen, and the fingers that move it."""

from playwright.sync_api import Locator, Page, expect

from tests.end_to_end.processes import until

COUNT = """(canvas) => {
  const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
  let count = 0;
  for (let at = 0; at < data.length; at += 4) if (data[at + 2] - data[at] > 60 && data[at + 3] > 200) count += 1;
  return count;
}"""
"""Opaque bluish pixels: the first curve of a plot is blue, while axes, grid, bands and markers are not."""
SEEN = """Object.defineProperty(document, "hidden", { get: () => window.away === true });"""
SEEN_AGAIN = """() => {
  for (const away of [true, false]) {
    window.away = away;
    document.dispatchEvent(new Event("visibilitychange"));
  }
}"""
"""Script for a page whose reader comes back: it shows what is new at once, not when the page asks next."""


def drawn(page: Page) -> list[int]:
    """Count for every plot the pixels of its first curve."""
    found = page.locator(".plot canvas")
    return [canvas.evaluate(COUNT) for canvas in found.all()]


def wait_drawn(page: Page, plots: int) -> None:
    """Wait until there are so many plots and each shows its first curve: axes and grid have no such pixel."""
    expect(page.locator(".plot canvas")).to_have_count(plots)
    until(lambda: all(count > 20 for count in drawn(page)), within_s=15, what=f"all curves are drawn: {drawn(page)}")


def looks(canvas: Locator) -> str:
    """Return what is drawn, to be compared."""
    return str(canvas.evaluate("canvas => canvas.toDataURL()"))


LISTEN = """place => {
  place.felt = 0;
  const count = ({ touches }) => { if (touches.length === 2) place.felt += 1; };
  place.addEventListener("touchmove", count, { passive: true });
}"""
"""Count the moves of two fingers that a place feels."""
TRIES = 3


def pinch(place: Locator) -> None:
    """Two fingers, apart; again where the browser let go of them before the page felt them move, as a person would."""
    place.evaluate(LISTEN)
    for _ in range(TRIES):
        touches(place, [[(0.45, 0.5), (0.55, 0.5)], [(0.4, 0.5), (0.6, 0.5)], [(0.3, 0.5), (0.7, 0.5)]])
        if place.evaluate("place => place.felt") > 0:
            return
    raise AssertionError(f"the browser did not give the page two moving fingers in {TRIES} tries")


def swipe(place: Locator) -> None:
    """One finger, upwards."""
    touches(place, [[(0.5, 0.9 - 0.1 * step)] for step in range(9)])


def touches(place: Locator, steps: list[list[tuple[float, float]]]) -> None:
    """Fingers at parts of a place, put down, moved and lifted."""
    box = place.bounding_box()
    assert box is not None
    session = place.page.context.new_cdp_session(place.page)
    for number, fingers in enumerate(steps):
        at = [
            {"x": box["x"] + x * box["width"], "y": box["y"] + y * box["height"], "id": id}
            for id, (x, y) in enumerate(fingers)
        ]
        session.send("Input.dispatchTouchEvent", {"type": "touchMove" if number else "touchStart", "touchPoints": at})
    session.send("Input.dispatchTouchEvent", {"type": "touchEnd", "touchPoints": []})
    session.detach()
