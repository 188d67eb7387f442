"""A characterization as table, data frame, LaTeX, HTML and figure; its errors near 0."""

import re

import numpy as np
import pytest

from characterizations import color, monochrome, plane_of
from chromanoise.apps.camera import QUANTITIES
from virtual_cameras import findings, scores, small_camera

PATTERNS = ("dsnu_e", "prnu", "row_noise_e", "column_noise_e")


def test_the_data_frame_holds_all_digits_of_value_and_error():
    pytest.importorskip("pandas", reason="to_dataframe needs pandas")
    result = color()
    frame = result.to_dataframe().set_index("value")
    for plane in result.planes:
        assert frame.loc["gain K", plane.name] == plane.gain_dn_per_e
        assert frame.loc["PRNU", f"{plane.name} standard error"] == plane.prnu_se
    assert frame.loc["gain K", "unit"] == "DN/e-"
    assert list(frame.index) == [one.name for one in QUANTITIES]


def test_a_value_that_is_not_known_or_finite_is_missing():
    plane = plane_of(qe=None, qe_se=None, dsnu_e=float("nan"))
    rows = {row[0]: row[2:] for row in monochrome(planes=(plane,)).to_table().rows}
    assert rows["QE"] == (None, None)
    assert rows["DSNU"] == (None, plane.dsnu_e_se)
    assert rows["dynamic range"] == (plane.dynamic_range_db, None)


def test_latex_is_rounded_and_has_a_row_per_value():
    latex = monochrome(planes=(plane_of(prnu=0.0061234567),)).to_latex("tab:camera")
    assert latex.count(r"\\") == 1 + len(QUANTITIES)
    assert "0.006123 " in latex
    assert "0.0061234" not in latex
    assert r"\label{tab:camera}" in latex


def test_html_and_one_line_name_the_camera_and_the_verdict():
    result = color()
    html = result._repr_html_()
    assert "Acme Model One, ISO 100" in html
    assert "the linear model holds" in html
    assert html.count("<tr>") == 1 + len(QUANTITIES)
    assert not re.search(r"(src|href|url)\s*[=(]|<script|<style", html)
    assert "\n" not in repr(result)
    assert len(repr(result)) < 160


def test_the_plot_is_the_photon_transfer_of_every_plane():
    import matplotlib.pyplot as plt

    result = color()
    ax = result.plot()
    names = ax.get_legend_handles_labels()[1]
    assert names == [plane.name for plane in result.planes]
    (line,) = (one for one in ax.lines if one.get_label() == "G1")
    levels = [one for one in result.planes[1].levels if one.fitted]
    variances = [one.variance_dn2 - one.dark_variance_dn2 for one in levels]
    assert np.asarray(line.get_ydata()) == pytest.approx(np.array(variances))
    assert result.plot(ax) is ax
    plt.close(ax.figure)


@pytest.mark.evidence
def test_errors_of_patterns_hold_where_the_truth_is_0_small_or_usual():
    found = [one for number in range(600) for one in findings(7, number, small_camera)]
    for kind in range(3):
        score = scores(one for one in found if one.camera % 3 == kind)
        for name in PATTERNS:
            assert score[name].within_3 >= 0.98, (kind, name)  # 200 values: 2 more by chance
            assert kind < 2 or 0.85 < score[name].sd_z < 1.15, name
    usual = [one.z for one in found if one.camera % 3 == 2 and one.parameter in PATTERNS]
    assert 0.84 < np.std(usual) < 1.0  # 800 values: 0.92 +- 0.025; errors 20 % off: 0.77, 1.15


def test_errors_of_patterns_hold_where_the_truth_is_0():
    found = [one for number in range(0, 60, 3) for one in findings(7, number, small_camera)]
    z = np.array([one.z for one in found if one.parameter in PATTERNS])
    assert z.size == 80
    assert (np.abs(z) > 3.2).sum() <= 2
    assert (np.abs(z) > 1).sum() > 10  # not padded: half of the values are above 0
