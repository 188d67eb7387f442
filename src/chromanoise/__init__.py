"""From photons to color, with the noise.

The folders follow the light, then the program; imports go down this list only (the list of
``pyproject.toml``, read from its end).

=============  =======================================================================
``spectra``    one wavelength grid; curves, illuminants, observers, reflectances
``scene``      light leaving the world: patches, charts, hyperspectral cubes
``sensor``     what a camera is: channels, filters, pixel, mosaic
``exposure``   light meets sensor: expected electrons (eq. 1-2), exposure rules
``noise``      sources, covariance (eq. 7), propagation, Monte Carlo
``geometry``   dual basis, contravariant coordinates (eq. 3-4), angles, VIF, ellipses
``color``      matrices (eq. 6), XYZ with covariance (eq. 5), Lab, Luv, sRGB
``metrics``    SNR, its bound, loss and budget; color error, filters, speed, bits
``imaging``    a cube through the camera: kernels, mosaic, demosaicing, sampling
``io``         file formats, in and out: spectra, cubes, pixels, matrices, tables
``catalog``    names to things: sensors, filters, illuminants; the user's own folder
``analysis``   one operating point at every stage; budgets, sweeps, comparison
``study``      a study: document, faults, run, records
``paper``      the paper's own study, Tables 2-5 and figures, as a user of the library
``charts``     results to chart records: marks, axes, table rows
``figures``    chart records to matplotlib Axes
``report``     one self-contained HTML file
``page``       the local page that answers while you drag
``cli``        options to a study, results to text
=============  =======================================================================

Equation numbers are those of Clouet, Vaillant & Alleysson, "Physical noise propagation in
color image construction: a geometrical interpretation", CIC27 (2019).
"""

__version__ = "0.1.0"
