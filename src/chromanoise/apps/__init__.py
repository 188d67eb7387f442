"""Applications: users of the library, whose names may change in any release.

`camera` measures noise from frames, `design` searches sensors, `training` makes noisy training
data, `paper` reproduces the paper.

"""
