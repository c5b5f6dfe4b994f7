#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# make.sh BUILD: packages of a build folder into BUILD/packages.
set -euo pipefail
build=$(realpath "$1")
cmake --build "$build" --target vernier_package_documents
rm -rf "$build/packages"
mkdir -p "$build/packages"
umask 022

# What the program, libvernier and the plugins link is needed; what only the window links (GLFW, libGL) and what reads
# VTP files (VTK) is loaded on demand, so it is recommended: without it Vernier draws with the processor, and the other
# surface formats are read. libvernier itself is of no package.
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir "$work/debian"
printf 'Source: vernier\n\nPackage: vernier\nArchitecture: any\n' >"$work/debian/control"
needed=("$build/bin/vernier" "$build/lib/libvernier.so" "$build"/lib/vernier/plugins/*/*.so)
demand=("$build"/lib/vernier/*.so)
arguments=("${needed[@]/#/-e}")
[ ! -e "${demand[0]}" ] || arguments+=(-dRecommends "${demand[@]/#/-e}")
(cd "$work" && dpkg-shlibdeps --ignore-missing-info -O -l"$build/lib" "${arguments[@]}") >"$work/found" 2>"$work/said" ||
  { cat "$work/said" >&2; exit 1; }
depends=$(sed -n 's/^shlibs:Depends=//p' "$work/found")
recommends=$(sed -n 's/^shlibs:Recommends=//p' "$work/found")
[ -n "$depends" ] || { echo "make.sh: dpkg-shlibdeps found nothing" >&2; exit 1; }

(cd "$build" && SOURCE_DATE_EPOCH=$(git log -1 --format=%ct 2>/dev/null || echo 0) cpack \
  -D CPACK_DEBIAN_VERNIER_PACKAGE_DEPENDS="$depends" \
  -D CPACK_DEBIAN_VERNIER_PACKAGE_RECOMMENDS="${recommends:+$recommends, }libgl1, shared-mime-info" \
  >packages/cpack.log 2>&1) || { cat "$build/packages/cpack.log" >&2; exit 1; }
rm -rf "$build/packages/_CPack_Packages" "$build/packages/cpack.log"
ls -l "$build/packages"
