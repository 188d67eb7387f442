"""Every figure of merit of a sensor in use: of its filters, and of it in its light."""
