"""Checks that frames can be evaluated together: one camera, size, gain and mosaic."""

from collections.abc import Callable, Iterable, Sequence
from typing import Any

from chromanoise.errors import InputError
from chromanoise.io.cubes.raw_cube import by
from chromanoise.io.frames.frame import FrameLevel, RawFrame
from chromanoise.sensor import Mosaic

MOST_LEVELS = 10_000
"""Most levels of one set."""
EXAMPLE = (
    "write capture.toml beside the frames, with these lines for each level: [[levels]] / "
    'flats = ["flat_01_*.tif"] / darks = ["dark_01_*.tif"] / time_ms = 10'
)
"""Remedy where the grouping of frames is unclear."""

_QUANTITIES: tuple[tuple[str, Callable[[RawFrame], Any], Callable[[Any], str]], ...] = (
    ("size", lambda frame: frame.shape, lambda shape: f"{by(shape)} pixels"),
    ("camera", lambda frame: frame.camera or None, str),
    ("ISO", lambda frame: frame.iso, lambda iso: f"ISO {iso:g}"),
    ("gain", lambda frame: frame.gain_setting, lambda gain: f"gain {gain:g}"),
    ("number of bits", lambda frame: frame.bits, lambda bits: f"{bits} bits"),
)


def refuse_mixed(source: str, frames: Sequence[RawFrame]) -> None:
    """Refuse frames of several sizes, cameras, ISO or gain settings, or numbers of bits.

    A frame whose file does not state the quantity agrees with all others.

    Raises
    ------
    InputError
        It names the first frame and the first that differs from it.
    """
    for name, quantity, shown in _QUANTITIES:
        known = [frame for frame in frames if quantity(frame) is not None]
        other = next((one for one in known if quantity(one) != quantity(known[0])), None)
        if other is not None:
            raise _mixed(source, name, known[0], other, (quantity, shown))


def mosaic_of_all(source: str, frames: Sequence[RawFrame]) -> Mosaic | None:
    """The mosaic of frames that agree in it; ``None`` if no file states one.

    Raises
    ------
    InputError
        If two frames differ; a frame without a mosaic differs from one with it.
    """
    if not frames:
        return None
    other = next((frame for frame in frames if frame.mosaic != frames[0].mosaic), None)
    if other is not None:
        raise _mixed(source, "mosaic", frames[0], other, (lambda one: one.mosaic, mosaic_text))
    return frames[0].mosaic


def mosaic_text(mosaic: Mosaic | None) -> str:
    """``RG/GB``, or ``no mosaic``."""
    if mosaic is None:
        return "no mosaic"
    sign = "" if all(len(name) == 1 for name in mosaic.names) else " "
    return "/".join(sign.join(row) for row in mosaic.pattern)


def refuse_few(
    source: str, levels: Iterable[FrameLevel], kinds: Sequence[str] = ("flats",)
) -> None:
    """Refuse a level with one flat, or dark, which gives no temporal variance.

    Parameters
    ----------
    source
        Of the frames, for the message.
    levels
        To check.
    kinds
        ``flats``, ``darks``.

    Raises
    ------
    InputError
        It names the level and the frame.
    """
    for level in levels:
        for kind in kinds:
            group = getattr(level, kind)
            if len(group) == 1:
                raise InputError(
                    source,
                    f"must have at least 2 {kind}, because one gives no temporal variance",
                    value=1,
                    found=f"has 1, {group[0].name}",
                    where=f"level {level.name!r}",
                    remedy=("take another", "leave the level out", EXAMPLE),
                )


def _mixed(
    source: str,
    name: str,
    one: RawFrame,
    other: RawFrame,
    how: tuple[Callable[[RawFrame], Any], Callable[[Any], str]],
) -> InputError:
    quantity, shown = how
    names = (shown_name(one), shown_name(other))
    return InputError(
        source,
        f"must have one {name}",
        value=(quantity(one), quantity(other)),
        found=f"{names[0]} has {shown(quantity(one))} and {names[1]} has {shown(quantity(other))}",
        remedy="evaluate them separately",
    )


def shown_name(frame: RawFrame) -> str:
    """Folder and name of a frame, for messages."""
    return f"{frame.path.parent.name}/{frame.name}"
