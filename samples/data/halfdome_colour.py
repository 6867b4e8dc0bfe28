#!/usr/bin/env python3
"""Colours of ground by slope and height: halfdome_colour.py DEM COLOURS. The same DEM gives the same colours."""
import sys

import numpy as np
from osgeo import gdal

gdal.UseExceptions()
src, dst = sys.argv[1:3]
fine = gdal.Warp('', src, format='MEM', width=2054, height=1750, resampleAlg='cubicspline')
h = fine.ReadAsArray().astype(float)
slope = np.degrees(np.arctan(np.hypot(np.gradient(h, axis=1) / 12.23, np.gradient(h, axis=0) / 15.42)))
def smooth(low, high, x):
    t = np.clip((x - low) / (high - low), 0, 1)
    return t * t * (3 - 2 * t)
def blurred(a, k):
    for axis in (0, 1, 0, 1):
        a = sum(np.roll(a, i, axis) for i in range(-k, k + 1)) / (2 * k + 1)
    return a / a.std()
random = np.random.default_rng(1)
noise = lambda k: blurred(random.normal(size=h.shape), k)
spots = 0.5 * noise(1) + 0.6 * noise(4) + 0.6 * noise(14)
def over(below, colour, share):
    return below * (1 - share[..., None]) + np.array(colour, float) * share[..., None]
c = np.zeros(h.shape + (3,)) + (62, 76, 46)                              # forest
c *= (1 + 0.16 * noise(1) + 0.08 * noise(4))[..., None]
c = over(c, (124, 130, 78), smooth(8, 4, slope) * smooth(1330, 1240, h) * smooth(0, 1, spots))  # meadows
c = over(c, (172, 163, 152), smooth(26, 38, slope + 7 * spots + (h - 2350) / 90))            # granite
c = over(c, (196, 192, 187), smooth(2750, 3200, h + 60 * spots))
c *= (1 + 0.05 * spots)[..., None]
out = gdal.GetDriverByName('MEM').Create('', h.shape[1], h.shape[0], 3)
out.SetGeoTransform(fine.GetGeoTransform()); out.SetProjection(fine.GetProjection())
for b in range(3):
    out.GetRasterBand(b + 1).WriteArray(np.clip(c[..., b], 0, 255).astype(np.uint8))
gdal.GetDriverByName('GTiff').CreateCopy(dst, out, options=['COMPRESS=JPEG', 'PHOTOMETRIC=YCBCR', 'JPEG_QUALITY=70', 'TILED=YES'])
