"""Files of raw frames in each format, written by other libraries."""

from functools import partial

import numpy as np
import tifffile
from PIL import Image

from chromanoise.imaging.dng import RawProfile, write_dng
from chromanoise.sensor import Adc, bayer


def drawn(height=24, width=30, top=4096, seed=1):
    codes = np.random.default_rng(seed).integers(0, top, (height, width)).astype(np.uint16)
    codes[0, :2] = 0, top - 1
    return codes


def write_npy(path, codes):
    np.save(path, codes)


def write_npz(path, codes):
    np.savez(path, flat=codes)


def write_packed_npz(path, codes):
    np.savez_compressed(path, flat=codes)


def write_tiff(path, codes, **options):
    tifffile.imwrite(path, codes, photometric="minisblack", metadata=None, **options)


def write_tiff_by_pillow(path, codes):
    Image.fromarray(codes).save(path, compression="tiff_lzw")


def write_fits(path, codes, **keys):
    from astropy.io import fits

    part = fits.PrimaryHDU(codes)
    part.header.update({key: value for key, value in keys.items() if value is not None})
    part.writeto(path)


def write_fits_of_floats(path, codes):
    write_fits(path, codes.astype(np.float32))


def write_fits_extension(path, codes):
    from astropy.io import fits

    image = fits.ImageHDU(codes, name="FLAT")
    fits.HDUList([fits.PrimaryHDU(), image]).writeto(path)


def write_pgm(path, codes):
    Image.fromarray(codes).save(path)


def write_plain_pgm(path, codes):
    height, width = codes.shape
    rows = "\n".join(" ".join(map(str, row)) for row in codes)
    path.write_text(f"P2\n# by hand\n{width} {height}\n# the largest\n4095\n{rows}\n")


def write_png(path, codes):
    Image.fromarray(codes).save(path)


def write_raw(path, codes, mosaic=None, **changed):
    profile = RawProfile(
        **{
            "sensor_name": "toy",
            "channels": ("R", "G", "B"),
            "mosaic": mosaic or bayer(),
            "adc": Adc(bits=12, gain_e_per_dn=2.0, black_level_dn=64),
            "white_level_dn": 4000,
            "color_matrix": np.eye(3) + 0.1,
            "as_shot_neutral": np.array([0.5, 1.0, 0.7]),
            "noise_profile": np.full((3, 2), 1e-4),
            "illuminant": "D65",
            **changed,
        }
    )
    write_dng(path, codes, profile)


def write_cropped_dng(path, codes, **options):
    """A DNG with 2 rows and 4 columns of masked pixels, so that its codes are not in place."""
    height, width = codes.shape
    area = (50829, 4, 4, (2, 4, 2 + height, 4 + width), True)
    write_plain_dng(path, np.pad(codes, ((2, 0), (4, 0))), area, **options)


def write_plain_dng(path, codes, *more, **options):
    """An uncompressed DNG by tifffile, with ``more`` tags."""
    unity = tuple(part for one in np.eye(3).ravel() for part in (int(one), 1))
    tags = [
        (272, 2, 0, "toy", True),
        (33421, 3, 2, (2, 2), True),
        (33422, 1, 4, bytes([0, 1, 1, 2]), True),
        (50706, 1, 4, bytes([1, 4, 0, 0]), True),
        (50708, 2, 0, "toy", True),
        (50714, 4, 1, 64, True),
        (50717, 4, 1, 4000, True),
        (50721, 10, 9, unity, True),
        *more,
    ]
    tifffile.imwrite(path, codes, photometric="cfa", extratags=tags, metadata=None, **options)


WRITERS = {
    "npy": ("a.npy", write_npy),
    "npz": ("a.npz", write_npz),
    "npz packed": ("a.npz", write_packed_npz),
    "tiff": ("a.tif", write_tiff),
    "tiff packed": ("a.tiff", partial(write_tiff, compression="zlib", predictor=True)),
    "tiff big-endian": ("a.tif", partial(write_tiff, byteorder=">")),
    "tiff tiled": ("a.tif", partial(write_tiff, tile=(16, 16), compression="lzma")),
    "tiff by pillow": ("a.tif", write_tiff_by_pillow),
    "fits": ("a.fits", write_fits),
    "fits floats": ("a.fit", write_fits_of_floats),
    "fits extension": ("a.fts", write_fits_extension),
    "pgm": ("a.pgm", write_pgm),
    "pgm plain": ("a.pgm", write_plain_pgm),
    "png": ("a.png", write_png),
    "dng": ("a.dng", write_raw),
    "dng by libraw": ("a.dng", write_cropped_dng),
    "dng tiled": ("a.dng", partial(write_plain_dng, tile=(16, 16))),
    # its only tile is larger than the picture
    "dng of one tile": ("a.dng", partial(write_plain_dng, tile=(48, 64))),
    "dng of cropped tiles": ("a.dng", partial(write_cropped_dng, tile=(16, 16))),
    "dng of one cropped tile": ("a.dng", partial(write_cropped_dng, tile=(48, 64))),
}
"""Name of the file and the function that writes one frame, by format."""
