"""Figures of merit of a sensor: of its filters, and of the sensor in its light."""
