"""Photographs of the page for docs/pictures: light, dark, on a phone, and a heat map.

Needs a chromium, and playwright of the dev extra: ``python tools/photograph_page.py``.
"""

from io import BytesIO
from pathlib import Path
from typing import Any

from PIL import Image

from served_page import chromium_path, served

PICTURES = Path(__file__).parents[1] / "docs" / "pictures"
WIDE = {"width": 1280, "height": 1640}
PHONE = {"width": 360, "height": 1480}
SHOTS = (("page-light", WIDE, "light"), ("page-dark", WIDE, "dark"), ("page-phone", PHONE, "light"))
_MAP_MS = 2000  # a map is computed after all other charts
_DRAWN = "section.panel[data-part]:not([data-part=picture])[aria-busy]"
_REST = f"""() => new Promise((done) => {{
    const look = () => document.documentElement.dataset.painted
        && document.querySelectorAll("{_DRAWN}").length === 0 ? done() : setTimeout(look, 20);
    look();
}})"""


def photograph(browser: Any, address: str, size: dict[str, int], scheme: str) -> bytes:
    """The page as PNG, once everything in it is drawn."""
    context = browser.new_context(viewport=size, color_scheme=scheme, reduced_motion="reduce")
    page = context.new_page()
    page.goto(address)
    page.evaluate(_REST)
    page.evaluate("document.querySelector('.card details').open = true")
    picture: bytes = page.screenshot()
    context.close()
    return picture


def photograph_of_map(browser: Any, address: str) -> bytes:
    """The heat map of the temperature of the light and its level as PNG."""
    page = browser.new_page(viewport=WIDE, color_scheme="light", reduced_motion="reduce")
    page.goto(address)
    panel = page.locator("section[data-part=map]")
    panel.scroll_into_view_if_needed()
    panel.get_by_label("Across", exact=True).select_option("kelvin")
    panel.get_by_label("Up", exact=True).select_option("lux")
    for label, value in (("Across, from", "1500"), ("Across, to", "4000"), ("Up, to", "0.1")):
        panel.get_by_label(label).fill(value)
        panel.get_by_label(label).press("Enter")
    page.evaluate("document.activeElement.blur()")
    page.locator(".d-map").wait_for()
    page.wait_for_timeout(_MAP_MS)
    page.evaluate(_REST)
    picture: bytes = panel.screenshot()
    page.close()
    return picture


def save(picture: bytes, path: Path) -> None:
    """With 256 colors: flat drawings lose nothing that the eye sees, and the file stays small."""
    image = Image.open(BytesIO(picture)).convert("RGB")
    image.quantize(256, dither=Image.Dither.NONE).save(path, optimize=True)


def main() -> None:
    """Write all photographs."""
    from playwright.sync_api import sync_playwright

    with served() as (address, _), sync_playwright() as started:
        browser = started.chromium.launch(executable_path=chromium_path(), args=["--no-sandbox"])
        for name, size, scheme in SHOTS:
            save(photograph(browser, address, size, scheme), PICTURES / f"{name}.png")
        save(photograph_of_map(browser, address), PICTURES / "page-map.png")
        browser.close()


if __name__ == "__main__":
    main()
