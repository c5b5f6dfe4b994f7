#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# The same small volume as teem writes it in each encoding: values -12 to 11, 4x3x2. Needs Debian's teem-apps.
set -e
work=$(mktemp -d)
python3 -c "import struct; open('$work/a.raw','wb').write(struct.pack('<24h', *range(-12, 12)))"
cat > "$work/a.nhdr" <<TXT
NRRD0004
type: short
dimension: 3
sizes: 4 3 2
space: RAS
space directions: (0.5,0,0) (0,0.75,0.1) (0.2,0,2)
space origin: (1,2,3)
endian: little
encoding: raw
data file: a.raw
TXT
for e in raw gzip bzip2 ascii; do teem-unu save -i "$work/a.nhdr" -f nrrd -e $e -o teem-$e.nrrd; done
teem-unu save -i "$work/a.nhdr" -f nrrd -e raw -en big -o teem-big.nrrd
teem-unu convert -t double -i "$work/a.nhdr" | teem-unu save -f nrrd -e gzip -o teem-double.nrrd
rm -r "$work"
