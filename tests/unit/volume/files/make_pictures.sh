#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# The same two small pictures in each format, by the programs of netpbm and libtiff; their values are in the tests:
# grey 8: value(x, y) = 40 x + 7 y, 6 columns, 5 rows; grey 16: value(x, y) = 9001 x + 701 y; row 0 on top.
# Needs Debian's netpbm and libtiff-tools.
set -e
work=$(mktemp -d)
python3 - "$work" <<'PY'
import struct, sys
w = sys.argv[1]
open(w + "/8.pgm", "wb").write(b"P5 6 5 255\n" + bytes(40 * x + 7 * y for y in range(5) for x in range(6)))
open(w + "/16.pgm", "wb").write(b"P5 6 5 65535\n" + b"".join(struct.pack(">H", 9001 * x + 701 * y) for y in range(5) for x in range(6)))
open(w + "/runs.pgm", "wb").write(b"P5 300 2 255\n" + bytes([7] * 200 + list(range(100)) + [9] * 300))
open(w + "/rgb.ppm", "wb").write(b"P6 6 5 255\n" + bytes(v for y in range(5) for x in range(6) for v in (40 * x, 50 * y, 200)))
PY
out=$(pwd)
cd "$work"
for n in 8 16; do
  pnmtopng $n.pgm > "$out/grey$n.png"
  pnmtopng -interlace $n.pgm > "$out/grey$n-interlaced.png"
  pamtotiff $n.pgm > "$out/grey$n.tif"
  tiffcp -c none -r 2 "$out/grey$n.tif" "$out/grey$n-strips.tif"
  tiffcp -B -c lzw:2 "$out/grey$n.tif" "$out/grey$n-big-lzw.tif"
  tiffcp -c zip -t -w 16 -l 16 "$out/grey$n.tif" "$out/grey$n-tiles.tif"
done
pnmtosgi -verbatim 8.pgm > "$out/grey8.rgb"
pnmtosgi -rle 8.pgm > "$out/grey8-rle.rgb"
pnmtosgi -verbatim 16.pgm > "$out/grey16.rgb"
pnmtosgi -rle 16.pgm > "$out/grey16-rle.rgb"
pnmtosgi -rle runs.pgm > "$out/runs.rgb"
pnmtosgi -rle rgb.ppm > "$out/colour.rgb"
pnmtopng -force rgb.ppm > "$out/colour.png"
pnmtopng rgb.ppm > "$out/palette.png"
pamtotiff -truecolor rgb.ppm > "$out/colour.tif"
rm -r "$work"
