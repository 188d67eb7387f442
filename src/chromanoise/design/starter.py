"""The commented design that `chromanoise init --design` writes."""

from chromanoise.study.document import LightPart

DESIGN_STARTER = f"""\
# A chromanoise design: `chromanoise optimize design.toml -o out/design` searches the sensors
# with the best trade-offs between the objectives. The tables outside of [design] are those of a
# study. File names are relative to the folder of this file.
schema = 1
title = "A sensor for 10 lx"
matrices = ["kernel"]                # or one of least-squares, lmmse, ridge=0.01 ...

[light]
illuminant = "E"                     # A, D65, 3200K, LED660, or a file
level_lux = {LightPart().level_lux}

[exposure]
f_number = 1.8                       # all sensors have one exposure time: the longest at which no
                                     # reference saturates; time_ms = 12 sets another

[[sensors]]                          # the references; the first one gives the pixel
name = "onyx-rgbw"

[[sensors]]
name = "onyx-rgb-ircut"

[design]
objectives = ["snr_y_db", "delta_e"] # SNR of Y and color error; also noise_delta_e,
                                     # ciede2000, vora, snr10_lux, least_separation ...
method = "nsga2"                     # nsga3; de or cma-es for one objective
budget = 100000                      # evaluated sensors
population = 200                     # sensors per generation
seed = 1

# 8 is a fixed number. [20, 80] is free between two bounds. So is
# {{low = 20, high = 80, start = 40, tolerance = 2}}. "R.width_nm" is the number of channel R.
[[design.channels]]
name = "R"
base = "W"                           # the curve of channel W of onyx-rgbw, in place of model
                                     # silicon: the designs and the references share it
filter = "gaussian"                  # resin, fabry-perot, dye ...
center_nm = [560, 680]
width_nm = [15, 80]                  # standard deviation
peak = 0.95

[[design.channels]]
name = "G"
base = "W"
filter = "gaussian"
center_nm = [500, 580]
width_nm = [15, 80]
peak = 0.95

[[design.channels]]
name = "B"
base = "W"
filter = "gaussian"
center_nm = [420, 500]
width_nm = [15, 80]
peak = 0.95

[design.ir_cut]                      # a filter in front of all channels
cutoff_nm = [600, 900]
width_nm = 8

# [[design.scenes]]                  # several scenes: the worst value counts; over_scenes =
                                     # "mean" in [design] takes the mean
# level_lux = 1.0
# illuminant = "A"

[[design.constraints]]               # no larger color error than the better reference
objective = "delta_e"
at_most = "best reference"           # or a number, or the name of a reference; or at_least
"""
"""The commented design file that ``chromanoise init --design`` writes."""
