"""Photographs of the page for docs/pictures: light, dark, and on a phone.

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
    picture: bytes = page.screenshot()
    context.close()
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
        browser.close()


if __name__ == "__main__":
    main()
