#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# make.sh BUILD: packages of a build folder into BUILD/packages.
set -euo pipefail
build=$1
cmake --build "$build" --target vernier_package_documents
rm -rf "$build/packages"
mkdir -p "$build/packages"
umask 022
(cd "$build" && SOURCE_DATE_EPOCH=$(git log -1 --format=%ct 2>/dev/null || echo 0) cpack >packages/cpack.log 2>&1) ||
  { cat "$build/packages/cpack.log" >&2; exit 1; }
rm -rf "$build/packages/_CPack_Packages" "$build/packages/cpack.log"
ls -l "$build/packages"
