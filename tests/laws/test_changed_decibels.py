"""`diff` sorts numbers in dB by the ratio that they stand for."""

import pytest

from chromanoise.study.run_differences import ChangedValue


@pytest.mark.parametrize(
    ("key", "first", "second", "share"),
    [("snr_y_db", 20.0, 40.0, 0.9), ("snr_y_db", -1.0, 1.0, 0.2057), ("mean_e", 20.0, 40.0, 0.5)],
)
def test_twenty_db_are_a_factor_of_ten(key, first, second, share):
    found = ChangedValue(key=key, first=first, second=second)
    assert found.relative == pytest.approx(share, abs=1e-4)
