"""Color error against color SNR loss: a point per camera, and the sensors among them."""

from matplotlib.axes import Axes

from chromanoise.apps.league.ranking import RANKED, League
from chromanoise.charts import INK, QUIET, chromanoise_style, sensor_mark, write_beside

_BY = (5.0, 3.0)  # points


def draw_cloud(league: League, ax: Axes) -> Axes:
    """Draw one point per camera and sensor; the cross is the spread of two measurements.

    Parameters
    ----------
    league
        With the cameras and the sensors of one's own.
    ax
        Axes of matplotlib.
    """
    across, up = RANKED[0], RANKED[1]
    with chromanoise_style():
        x, y = ([getattr(one, axis.name) for one in league.cameras] for axis in (across, up))
        ax.scatter(x, y, s=18, color=QUIET, label=f"{len(league.cameras)} cameras")
        best = min(league.cameras, key=lambda one: getattr(one, up.name))
        for one in {league.cameras[0].name: league.cameras[0], best.name: best}.values():
            write_beside(ax, one.name, (getattr(one, across.name), getattr(one, up.name)), _BY)
        for i, one in enumerate(league.sensors):
            at = getattr(one, across.name), getattr(one, up.name)
            ax.plot(*at, label=one.name, **sensor_mark(i))
            write_beside(ax, one.name, at, _BY)
        ax.errorbar(max(x), min(y), xerr=across.spread, yerr=up.spread, color=INK, linewidth=1)
        ax.set(
            xlabel=f"{across.label} [{across.unit}]",
            ylabel=f"mean {up.label} [{up.unit.replace('Delta E', 'ΔE')}]",
            title="Color accuracy and its noise",
        )
    return ax
