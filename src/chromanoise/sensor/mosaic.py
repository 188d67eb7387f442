"""Which channel sits over which pixel."""

from dataclasses import dataclass

from chromanoise import _check


@dataclass(frozen=True, slots=True)
class Mosaic:
    """The smallest block of channel names that tiles the sensor.

    Attributes
    ----------
    pattern
        Rows of channel names, all of the same length.
    """

    pattern: tuple[tuple[str, ...], ...]

    def __post_init__(self) -> None:
        if not self.pattern or not self.pattern[0]:
            raise _check.InputError("a mosaic needs at least one row with one channel")
        for i, row in enumerate(self.pattern):
            if len(row) != len(self.pattern[0]):
                raise _check.InputError(
                    f"mosaic rows must be equally long, but row {i} has {len(row)} channels "
                    f"and row 0 has {len(self.pattern[0])}"
                )

    @property
    def names(self) -> tuple[str, ...]:
        """The channels that occur, in order of first appearance."""
        return tuple(dict.fromkeys(name for row in self.pattern for name in row))


def bayer() -> Mosaic:
    """2 x 2, half of it green (Bayer, US 3,971,065)."""
    return _mosaic("RG", "GB")


def rgbw_2x2() -> Mosaic:
    """2 x 2, one pixel of each of R, G, B and W."""
    return _mosaic("RG", "WB")


def rgbw_sparse_4x4() -> Mosaic:
    """4 x 4, three quarters white: few colored pixels in a white sensor."""
    return _mosaic("RWGW", "WWWW", "GWBW", "WWWW")


def _mosaic(*rows: str) -> Mosaic:
    return Mosaic(tuple(tuple(row) for row in rows))
