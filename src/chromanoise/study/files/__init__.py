"""Sensors, spectra, matrices and tables as text that other programs read, and back again."""
