"""From photons to color, with the noise.

The folders stand in the order of the light; imports go down this list only.

=============  =======================================================================
``spectra``    one wavelength grid; curves, illuminants, observers, reflectances
``scene``      light leaving the world: patches, charts, hyperspectral cubes
``sensor``     what a camera is: channels, filters, pixel, mosaic, catalogue
``exposure``   light meets sensor: expected electrons (eq. 1-2), time to saturation
``noise``      sources, covariance (eq. 7), propagation, Monte Carlo
``geometry``   dual basis, contravariant coordinates (eq. 3-4), angles, VIF, ellipses
``color``      matrices (eq. 6), XYZ with covariance (eq. 5), Lab, Luv, sRGB
``merit``      SNR, its bound, price and budget; color error, filters, speed, bits
``imaging``    the same way for a whole picture
``study``      one reproducible run; sweeps; the paper's own Tables 2-5
``figures``    results -> matplotlib Axes
``report``     one self-contained page
``page``       the local page that answers while you drag
``cli``        read, one library call, write
=============  =======================================================================

Equation numbers are those of Clouet, Vaillant & Alleysson, "Physical noise propagation in
color image construction: a geometrical interpretation", CIC27 (2019).
"""

__version__ = "0.1.0"
