"""The commented design that `chromanoise init --design` writes."""

DESIGN_STARTER = """\
# A chromanoise design: `chromanoise optimize design.toml -o out/design` searches the best trades
# between the objectives. The tables outside of [design] are those of a study; file names are
# relative to the folder of this file.
schema = 1
title = "A sensor for 10 lx"
matrices = ["kernel"]                # one: kernel, least-squares, lmmse, ridge=0.01 ...

[light]
illuminant = "E"                     # A, D65, 3200K, LED660, or a file
level_lux = 10.0

[exposure]
f_number = 1.8                       # one time for all: the longest at which no reference
                                     # saturates; time_ms = 12 sets it

[[sensors]]                          # the references; the first gives the pixel of the designs
name = "onyx-rgbw"

[[sensors]]
name = "onyx-rgb-ircut"

[design]
objectives = ["snr_y_db", "delta_e"] # higher SNR of Y, lower color error; also noise_delta_e,
                                     # ciede2000, vora, snr10_lux, least_separation ...
method = "nsga2"                     # nsga3; de or cma-es for one objective
budget = 20000                       # evaluated sensors
population = 200                     # of them per generation
seed = 1

# A number is fixed; [low, high] is free; {low = 20, high = 80, start = 40, tolerance = 2} too;
# "R.width_nm" is that of channel R.
[[design.channels]]
name = "R"
filter = "gaussian"                  # resin, ir-cut ...
center_nm = [560, 680]
width_nm = [15, 80]                  # standard deviation
peak = 0.95

[[design.channels]]
name = "G"
filter = "gaussian"
center_nm = [500, 580]
width_nm = [15, 80]
peak = 0.95

[[design.channels]]
name = "B"
filter = "gaussian"
center_nm = [420, 500]
width_nm = [15, 80]
peak = 0.95

[design.ir_cut]                      # in front of all channels
cutoff_nm = [600, 900]
width_nm = 8

[design.silicon]
depth_um = 4                         # collection depth

# [[design.scenes]]                  # several scenes: the worst one counts, or the mean
# level_lux = 1.0
# illuminant = "A"

# [[design.constraints]]
# objective = "delta_e"
# at_most = "best reference"         # a number, or the name of a reference; or at_least
"""
