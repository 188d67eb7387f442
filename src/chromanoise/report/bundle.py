"""Parts of a self-contained HTML file: modules as data: URLs, data as compressed JSON."""

import base64
import gzip
import hashlib
import json
from importlib import resources
from typing import Any

from chromanoise._palette import palette_css

_DRAW = "figures/draw"


def drawing_style() -> str:
    """The style sheet of the drawing modules, with the palette."""
    return palette_css() + _asset("draw.css")


def import_map() -> str:
    """An import map with every drawing module as a data: URL.

    Modules import each other as ``draw/svg.js``; a browser loads no other file.
    """
    folder = resources.files("chromanoise").joinpath(_DRAW)
    names = sorted(one.name for one in folder.iterdir() if one.name.endswith(".js"))
    found = {
        f"draw/{name}": data_address(_asset(name).encode(), "text/javascript") for name in names
    }
    return json.dumps({"imports": found}, separators=(",", ":"))


def report_script() -> str:
    """The script that draws a report and handles its sliders."""
    return resources.files("chromanoise.report").joinpath("report.js").read_text("utf-8")


def data_address(content: bytes, kind: str) -> str:
    """Content as a data: URL.

    Examples
    --------
    >>> data_address(b"1", "text/plain")
    'data:text/plain;base64,MQ=='
    """
    return f"data:{kind};base64,{base64.b64encode(content).decode('ascii')}"


def packed_json(data: Any) -> str:
    """Data as JSON, compressed by gzip and encoded in base64, which is safe inside HTML.

    Equal data give equal text.

    Examples
    --------
    >>> import gzip
    >>> gzip.decompress(base64.b64decode(packed_json({"title": "</script>"})))
    b'{"title":"</script>"}'
    """
    text = json.dumps(data, separators=(",", ":"), allow_nan=False, ensure_ascii=False)
    return base64.b64encode(gzip.compress(text.encode("utf-8"), mtime=0)).decode("ascii")


def script_hash(script: str) -> str:
    """The hash of an inline script for a content security policy."""
    digest = hashlib.sha256(script.encode("utf-8")).digest()
    return f"'sha256-{base64.b64encode(digest).decode('ascii')}'"


def shortened(data: Any, *, digits: int = 5) -> Any:
    """The data with every number rounded to ``digits`` digits, safe for later rounding.

    Parameters
    ----------
    data
        Plain data.
    digits
        Significant ones; a number that would end in a 5 there keeps more, so that rounding it to
        fewer gives what rounding the number itself gives. [1]

    Examples
    --------
    >>> shortened([26.123456, 26.2496, 12.0, "26.2496"])
    [26.123, 26.2496, 12, '26.2496']
    """
    if isinstance(data, float):
        return _shortened(data, digits)
    if isinstance(data, dict):
        return {key: shortened(value, digits=digits) for key, value in data.items()}
    if isinstance(data, list | tuple):
        return [shortened(value, digits=digits) for value in data]
    return data


def _shortened(value: float, digits: int) -> float | int:
    for more in range(digits, 18):
        text = f"{value:.{more - 1}e}"
        mantissa = text.partition("e")[0].rstrip("0")
        if not mantissa.endswith("5"):
            value = float(text)
            break
    return int(value) if value.is_integer() and abs(value) < 1e15 else value


def _asset(name: str) -> str:
    return resources.files("chromanoise").joinpath(_DRAW, name).read_text("utf-8")
