"""A patch whose color is lost in the noise of one pixel is called so, and is no giant ellipse."""

from chromanoise.charts import drawing, shown
from chromanoise.study import study_from_data


def of(level_lux):
    data = {"sensors": [{"name": "onyx-rgbw"}], "exposure": {"time_ms": 12.0}}
    return shown(study_from_data(data | {"light": {"level_lux": level_lux}}, source=""))


def test_in_the_dark_every_patch_is_lost_and_in_light_none():
    dark, light = (drawing("chart", of(lux)).panels[0].marks[1] for lux in (0.01, 10.0))
    assert {noise for _, noise in dark.texts} == {"lost"}
    assert not any(noise == "lost" for _, noise in light.texts)
    assert drawing("ellipses", of(0.01)).panels == ()
    assert len(drawing("ellipses", of(10.0)).panels[0].marks[0].colors) == 24
