"""What an interactive session prints of a record fits in a few lines, however large its arrays."""

import pytest

import chromanoise as cn
from chromanoise.spectra import builtin_cube, colorchecker
from chromanoise.study import PipelineSettings, chart_noise, pipeline_noise

FEW = 480  # characters: some five lines of a terminal


@pytest.fixture(scope="module")
def records():
    result = cn.analyze("onyx-rgbw", matrix="kernel")
    (one,) = result.analyses
    return {
        "Sensor": one.sensor,
        "Spectra": colorchecker(one.sensor.grid),
        "Illuminant": one.scene.illuminant,
        "Scene": one.scene,
        "Cube": builtin_cube("builtin:checker"),
        "ColorMatrix": one.matrix,
        "DualBasis": one.matrix.frame,
        "OperatingPoint": one.point,
        "Analysis": one,
        "Outcome": result.outcomes[0],
        "PipelineNoise": pipeline_noise(one, PipelineSettings()),
        "ChartNoise": chart_noise(one),
        "Table": result.to_table(),
    }


@pytest.mark.evidence
def test_each_record_is_shown_by_its_class_in_a_few_lines(records):
    for kind, one in records.items():
        text = repr(one)
        assert text.startswith(f"{kind}(")
        assert "\n" not in text, kind
        assert len(text) <= FEW, kind


def test_names_and_the_sizes_of_arrays_are_shown(records):
    text = repr(records["Sensor"])
    assert "name='onyx-rgbw'" in text
    assert "qe=<131 x 4 float64>" in text
    assert "illuminant=Illuminant(E)" in repr(records["Scene"])
