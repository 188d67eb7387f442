"""The commented study that `chromanoise init` writes."""

from chromanoise.study.document import LightPart

STARTER = f"""\
# A chromanoise study: `chromanoise run study.toml` computes all of it, and
# `chromanoise rerun out/study -o out/again` computes it again and compares the results. File
# names are relative to the folder of this file.
schema = 1
title = "Can the IR-cut be dropped?"
metric = "quanta"                    # spectra in photons (quanta) or in energy
seed = 0                             # of all noise that is drawn
matrices = ["kernel", "lmmse"]       # least-squares, white-preserving, ridge=0.01,
                                     # noise-regularized=1, bounded-psi=6.5
# prior = "chart-nir"                # of trained matrices: chart, smooth-50, smooth-100 ...

[light]
illuminant = "E"                     # A, D65, G173, 3200K, LED660, or a file
level_lux = {LightPart().level_lux}
# beyond = "hold"                    # what the curve is beyond its end: refuse, zero, hold

[exposure]
equal = "exposure"                   # one time for all; or saturation, or light
# saturate = 0.99                    # of full well, for the most sensitive of them
# time_ms = 12                       # instead of saturate
f_number = 1.8

[[sensors]]
name = "onyx-rgbw"                   # of `chromanoise catalog sensors`, or a file of QE curves

[[sensors]]
name = "onyx-rgb-ircut"
# label = "old"                      # shown in place of the name
# filter = "ircut-650"               # in front of it: of `chromanoise catalog filters`, or a file
# [sensors.pixel]
# file = "sheet.txt"                 # EMVA 1288 sheet, DNG noise profile, photon transfer
# read_noise_e = 2.0                 # pitch_um, full_well_e; they win over the file

[[sweeps]]
vary = "lux"                         # time-ms, f-number, read-noise-e, ircut-nm ...
first = 0.01
last = 1000
points = 61
quantity = "snr-y"                   # snr-x, snr-z, bound, price, delta-e, color-error
# second = {{vary = "f-number", first = 1.4, last = 8.0}}  # a second parameter: a heat map

# [[pictures]]
# cube = "builtin:checker"           # of `chromanoise catalog scenes`, or a file of reflectances
# mosaic = "sensor"                  # raw codes and demosaicing; bayer, RG/GB ...
# denoise = "guided"                 # the electrons, with their known noise, before color
# frames = 1                         # of a burst; formats, bits, noise of the pixel ...

[outputs]
budget = true                        # dB per cause
chart = false                        # every patch of the ColorChecker
# merit = true                       # Vora, SMI, ISO speed, visual noise ...
# matrix = true                      # each color matrix with its color error and noise
# space = "lab"                      # noise of an 18 % gray in lab, luv, srgb, linear-srgb

# [outputs.pipeline]                 # the camera's own, to sRGB, Y'CbCr and Lab, at every ISO
# run = true
# white_balance = "gray"             # illuminant, D65 ..., or [2.0, 1.0, 1.6]
# iso = [100, 400, 1600]
"""
"""The commented study file that ``chromanoise init`` writes."""
