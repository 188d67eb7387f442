"""Search over filters, IR-cut, pixel shares, exposure and matrix of a sensor."""
