"""Sensors against each other while one thing varies: sweeps, quantities, curves, crossovers."""
