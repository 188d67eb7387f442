"""Photographs of the page, of reports and of the demo for docs/pictures.

Needs a chromium, and playwright of the dev extra: ``python tools/photograph_page.py [NAME ...]``;
without names it takes all pictures.
"""

import base64
import json
import subprocess
import sys
import tempfile
from collections.abc import Callable, Mapping
from contextlib import closing
from dataclasses import dataclass
from importlib import import_module
from io import BytesIO
from pathlib import Path
from typing import Any

from PIL import Image

from served_page import chromium_path, served

ROOT = Path(__file__).parents[1]
PICTURES = ROOT / "docs" / "pictures"
WIDE = {"width": 1280, "height": 800}
TALL = {"width": 1280, "height": 1640}
PHONE = {"width": 390, "height": 844}
SENSORS = ("onyx-rgbw", "onyx-rgb-ircut", "onyx-rgb")
_PATIENCE_MS = 300_000
_MOST_BYTES = 150_000
_MAP_MS = 2000  # a map is computed after all other charts
_DRAWN = "section.panel[data-part]:not([data-part=picture])[aria-busy]"
_REST = f"""() => new Promise((done) => {{
    const look = () => document.documentElement.dataset.painted
        && document.querySelectorAll("{_DRAWN}").length === 0 ? done() : setTimeout(look, 20);
    look();
}})"""
_PICTURE = """() => new Promise((done) => {
    const panel = document.querySelector("[data-part=picture]");
    const look = () => panel.querySelector("img") && !panel.hasAttribute("aria-busy")
        ? done() : setTimeout(look, 20);
    look();
})"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Shot:
    """One photograph of the page: a state, what is done there, and what is taken."""

    state: Mapping[str, Any] | None = None
    act: Callable[[Any], object] = lambda page: None
    size: Mapping[str, int] | None = None
    scheme: str = "light"
    medium: str = "screen"
    part: str | None = None


def _with(count: int, **study: object) -> dict[str, Any]:
    sensors = [
        {"name": SENSORS[i % 3]} | ({"shift_nm": 5.0 * (i // 3)} if i > 2 else {})
        for i in range(count)
    ]
    return {"study": {"sensors": sensors} | study, "look": {}}


def _open_card(page: Any) -> None:
    page.evaluate("document.querySelector('.card details').open = true")


def _hover(page: Any) -> None:
    figure = page.locator("section[data-part=levels] svg.d-figure")
    figure.scroll_into_view_if_needed()
    box = figure.bounding_box()
    for share in (0.3, 0.35, 0.4, 0.45, 0.5):
        page.mouse.move(box["x"] + 0.55 * box["width"], box["y"] + share * box["height"])
        if page.locator(".d-tip:visible").count():
            return


def _map(page: Any) -> None:
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


def _tour(page: Any) -> None:
    page.locator("#tour").click()
    page.locator("#story:not([hidden])").wait_for()
    page.wait_for_timeout(2 * _MAP_MS)


def _explain(page: Any) -> None:
    page.locator("section[data-part=budget] [data-equation]").first.click()
    page.locator("dialog[open] math").first.wait_for()


def _front(page: Any) -> None:
    sys.path.insert(0, str(ROOT / "tests"))
    content = import_module("fronts").front_of_ir_cuts().as_json().encode()
    page.set_input_files(
        "#file", {"name": "front.json", "mimeType": "application/json", "buffer": content}
    )
    page.locator("section[data-part=front] .d-figure").first.wait_for()


SHOTS: Mapping[str, Shot] = {
    "page-light": Shot(act=_open_card, size=TALL),
    "page-dark": Shot(act=_open_card, size=TALL, scheme="dark"),
    "page-first": Shot(),
    "page-first-dark": Shot(scheme="dark"),
    "page-printed": Shot(medium="print"),
    "page-phone": Shot(size=PHONE),
    "page-phone-sheet": Shot(size=PHONE, act=lambda page: page.locator("#sheet").click()),
    "page-tour": Shot(act=_tour),
    "page-explanation": Shot(act=_explain),
    "page-map": Shot(size=TALL, act=_map, part="map"),
    "page-hover": Shot(act=_hover),
    "page-ten-sensors": Shot(state=_with(10), size=TALL),
    "page-reader": Shot(state=_with(2, outputs={"reader": "machine"})),
    "page-front": Shot(size=TALL, act=_front, part="front"),
    "page-denoising": Shot(
        state=_with(2, light={"level_lux": 3.0}, pictures=[{"denoise": "guided"}]), part="picture"
    ),
}
"""The screens of the page, by the name of the picture."""


def photograph(browser: Any, address: str, shot: Shot) -> bytes:
    """The page as PNG, once everything in it is drawn."""
    context = browser.new_context(
        viewport=dict(shot.size or WIDE), color_scheme=shot.scheme, reduced_motion="reduce"
    )
    context.set_default_timeout(_PATIENCE_MS)
    with closing(context):
        return _photographed(context.new_page(), address, shot)


def _photographed(page: Any, address: str, shot: Shot) -> bytes:
    state = "" if shot.state is None else _packed(shot.state)
    page.goto(address + (f"#{state}" if state else ""))
    page.evaluate(_REST)
    page.evaluate(_PICTURE)
    page.emulate_media(media=shot.medium)
    shot.act(page)
    page.evaluate(_REST)
    taken = page if shot.part is None else page.locator(f"section[data-part={shot.part}]")
    picture: bytes = taken.screenshot()
    return picture


def photograph_file(browser: Any, path: Path, heading: str | None = None) -> bytes:
    """A written HTML file as PNG, from its top or from one of its headings on."""
    page = browser.new_page(viewport=WIDE, color_scheme="light")
    page.goto(path.as_uri())
    page.wait_for_timeout(_MAP_MS)
    if heading is not None:
        page.get_by_role("heading", name=heading).first.evaluate("(one) => one.scrollIntoView()")
    picture: bytes = page.screenshot()
    page.close()
    return picture


def _packed(state: Mapping[str, Any]) -> str:
    return base64.urlsafe_b64encode(json.dumps(state).encode()).decode().rstrip("=")


def _chromanoise(*arguments: str, folder: Path) -> None:
    command = "from chromanoise.cli import main; main()"
    subprocess.run([sys.executable, "-c", command, *arguments], cwd=folder, check=True)


def _report(browser: Any, folder: Path) -> bytes:
    (folder / "study.toml").write_text(
        '[[sensors]]\nname = "onyx-rgbw"\n[[sensors]]\nname = "onyx-rgb-ircut"\n', encoding="utf-8"
    )
    _chromanoise("report", "study.toml", "-o", "report.html", folder=folder)
    return photograph_file(browser, folder / "report.html")


def _report_with_sweeps(browser: Any, folder: Path) -> bytes:
    (folder / "swept.toml").write_text(
        '[[sensors]]\nname = "onyx-rgbw"\n[[sensors]]\nname = "onyx-rgb-ircut"\n'
        '[[sweeps]]\nvary = "read-noise-e"\nfirst = 1.0\nlast = 30.0\npoints = 9\n',
        encoding="utf-8",
    )
    _chromanoise("report", "swept.toml", "-o", "swept.html", folder=folder)
    return photograph_file(browser, folder / "swept.html", "Sweep")


def _demo(browser: Any, folder: Path) -> bytes:
    _chromanoise("demo", folder=folder)
    return photograph_file(browser, folder / "out" / "demo" / "index.html")


def _card(_browser: Any, folder: Path) -> bytes:
    _chromanoise("card", *SENSORS[:2], "--lux", "3", "-o", "card.png", folder=folder)
    whole = Image.open(folder / "card.png").convert("RGB").resize((1280, 720))
    whole.save(written := BytesIO(), "png")
    return written.getvalue()


FILES: Mapping[str, Callable[[Any, Path], bytes]] = {
    "report": _report,
    "report-sweeps": _report_with_sweeps,
    "demo": _demo,
    "card": _card,
}
"""The screens of written files, by the name of the picture."""


def save(picture: bytes, path: Path) -> None:
    """With 256 colors, or fewer where the file would be larger than `_MOST_BYTES`."""
    image = Image.open(BytesIO(picture)).convert("RGB")
    for colors in (256, 128, 64, 32):
        image.quantize(colors, Image.Quantize.MAXCOVERAGE, kmeans=2, dither=Image.Dither.NONE).save(
            path, optimize=True
        )
        if path.stat().st_size < _MOST_BYTES:
            return


def main() -> None:
    """Write the photographs."""
    from playwright.sync_api import sync_playwright

    names = sys.argv[1:] or [*SHOTS, *FILES]
    with sync_playwright() as started, tempfile.TemporaryDirectory() as folder:
        browser = started.chromium.launch(executable_path=chromium_path(), args=["--no-sandbox"])
        with served() as (address, _):
            for name in (one for one in names if one in SHOTS):
                save(photograph(browser, address, SHOTS[name]), PICTURES / f"{name}.png")
        for name in (one for one in names if one in FILES):
            save(FILES[name](browser, Path(folder)), PICTURES / f"{name}.png")
        browser.close()


if __name__ == "__main__":
    main()
