#!/usr/bin/env bash
# run.sh BUILD_DIR [PEER_BUILD_DIR [WORK_DIR]]: the timing tables. With the peer's build folder both are measured in the
# same run, in turn; without it our own frames alone. Times differ between machines and runs: ratios under 1.5 prove
# nothing.
set -euo pipefail
build=$1
peer=${2:-}
work=${3:-out/bench}
vernier=$build/bin/vernier
here=$(dirname "$0")
mkdir -p "$work"
cmake --build "$build" --target vernier_bench_lens >/dev/null
if [ -n "$peer" ]; then
  python3 "$here/peers.py" "$vernier" "$peer" "$work"
  exec python3 "$here/lens_table.py" "$build/bench/vernier_bench_lens" --peer "$peer/vtk_peers" --work "$work"
fi
python3 "$here/lens_table.py" "$build/bench/vernier_bench_lens"
"$build/bench/vernier_bench_lens" move
[ -d "$work/ct-head" ] || "$vernier" phantom ct-head --out "$work"
for engine in native gl; do
  for view in stack axial coronal sagittal oblique slab; do
    [ "$engine $view" = "gl stack" ] && continue
    "$vernier" bench "$work/ct-head" --view "$view" --engine "$engine" --window 500,1400
  done
done
# Looks through a volume as the desktop draws them while they turn.
cmake --build "$build" --target vernier_bench_looks >/dev/null
"$build/bin/vernier_bench_looks" "$work/ct-head"
# The window, on a virtual display: with a picture of 512x512, and in its usual size.
command -v xvfb-run >/dev/null || exit 0
cmake --build "$build" --target vernier_bench_window >/dev/null
[ -d "$work/two/vessels" ] || "$vernier" phantom vessels --out "$work/two"
[ -d "$work/two/ct-head" ] || "$vernier" phantom ct-head --out "$work/two"
rm -f "$work"/two/*.json
for size in 808x636 1280x800; do
  xvfb-run -a -s "-screen 0 1920x1200x24" "$build/bin/vernier_bench_window" "$work/two" "$size"
done
