#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# check.sh BUILD: makes the packages and proves what they promise, as root, in a root folder that holds nothing but the
# packages that vernier depends on:
#   - lintian, desktop-file-validate and appstreamcli find no fault, and man shows every command;
#   - it installs with every dependency met, without OpenGL, OSMesa or GLFW anywhere in sight;
#   - it finds every plugin of the build, writes a phantom, renders it natively to the very pixels that the build renders outside;
#   - `doctor` says why there is no OpenGL and no window;
#   - a user's own plugin can be built against vernier-dev;
#   - removing it leaves the root folder as it was.
set -euo pipefail
build=$(realpath "$1")
here=$(realpath "$(dirname "$0")")
[ "$(id -u)" = 0 ] || { echo "check.sh: needs root for chroot; run ./dev package --check" >&2; exit 1; }

say() { echo "check: $*"; }
fail() { echo "check: FAILED: $*" >&2; exit 1; }

bash "$here/make.sh" "$build" >/dev/null
deb=$(ls "$build"/packages/vernier_*.deb)
dev=$(ls "$build"/packages/vernier-dev_*.deb)
root=$(mktemp -d "${TMPDIR:-/tmp}/vernier-root.XXXXXX")
trap 'rm -rf "$root"' EXIT
chmod 755 "$root"

say "faults that the judges find"
lintian --allow-root --no-cfg --fail-on error,warning "$deb" "$dev" || fail "lintian"
unpacked=$root/unpacked
dpkg-deb -x "$deb" "$unpacked"
desktop-file-validate "$unpacked"/usr/share/applications/vernier.desktop || fail "desktop file"
appstreamcli validate-tree --no-net --pedantic "$unpacked" >"$root/appstream" ||
  { cat "$root/appstream"; fail "AppStream metainfo"; }
LC_ALL=C.UTF-8 MANWIDTH=100 man -l --warnings "$unpacked"/usr/share/man/man1/vernier.1.gz 2>"$root/man" >"$root/page" || true
[ ! -s "$root/man" ] || { cat "$root/man"; fail "man page"; }
"$build/bin/vernier" --help | sed -n '/^Subcommands:/,/^$/{/not built yet/d;s/^  \([a-z]\+\) .*/\1/p}' |
  diff - <(sed -n '/^COMMANDS/,/^ENVIRONMENT/s/^   \([a-z]\+\)$/\1/p' "$root/page") || fail "the man page has other commands than the program"
sort "$build/packaging/plugins.txt" | diff - <(ls "$unpacked/usr/lib/vernier/plugins") || fail "the package has other plugins than the build"

say "a plugin from elsewhere against vernier-dev"
dpkg-deb -x "$dev" "$unpacked"
cp -r "$here/../plugins/example" "$root/example"
cmake -S "$root/example" -B "$root/example/build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DCMAKE_PREFIX_PATH="$unpacked/usr" \
  >"$root/said" 2>&1 && cmake --build "$root/example/build" >>"$root/said" 2>&1 || { cat "$root/said"; fail "the example does not build"; }
grep "other ABI" "$root/said" && fail "the example is built in another way than the package"
"$unpacked/usr/bin/vernier" plugins --plugins "$root/example/build/lib/vernier/plugins" >"$root/page" || fail "vernier plugins"
grep -q "^example .* loaded" "$root/page" || { cat "$root/page"; fail "the example is not loaded"; }
rm -rf "$unpacked" "$root"/{appstream,man,page,said,example}

say "a root folder of nothing but the dependencies"
mapfile -t packages < <(python3 "$here/closure.py" "$deb" base-files dash coreutils)
[ ${#packages[@]} -gt 5 ] || fail "no dependencies found"
mkdir -p "$root"/var/lib/dpkg/{info,updates,triggers} "$root"/{tmp,dev,proc,usr/bin,usr/lib,usr/lib64,usr/sbin}
for d in bin lib lib64 sbin; do ln -s "usr/$d" "$root/$d"; done
dpkg-query -s "${packages[@]}" >"$root/var/lib/dpkg/status"
for p in "${packages[@]}"; do cp /var/lib/dpkg/info/"$p"{,:*}.list "$root/var/lib/dpkg/info" 2>/dev/null || true; done
dpkg-query -L "${packages[@]}" | grep '^/.' | sort -u |
  sed 's#^/\(bin\|lib\|lib64\|sbin\)/#/usr/\1/#; s#^/##' |
  grep -v -e '^usr/share/\(doc\|man\|locale\)/' -e '^\(bin\|lib\|lib64\|sbin\)$' |
  tar -C / --no-recursion --ignore-failed-read -cf - -T - 2>/dev/null | tar -C "$root" -xf -
say "${#packages[@]} packages, $(du -sm "$root" | cut -f1) MB"
if find "$root" -name 'libGL.so*' -o -name 'libGLX*' -o -name 'libOSMesa*' -o -name 'libglfw*' -o -name 'libEGL*' |
  grep .; then fail "the dependencies bring OpenGL or a window"; fi
list() { (cd "$root" && find . -path ./var/lib/dpkg -prune -o -print | sort); }
list >"$build/packages/before.txt"

say "installed, run, removed"
dpkg --root="$root" --log=/dev/null -i "$deb" >"$build/packages/dpkg.log" 2>&1 || { cat "$build/packages/dpkg.log"; fail "dpkg -i"; }
inside() { chroot "$root" /usr/bin/env -i PATH=/usr/bin HOME=/tmp LC_ALL=C.UTF-8 "$@"; }
inside vernier plugins --json >"$build/packages/plugins.json"
inside vernier phantom small-ct --out /tmp/study >/dev/null
inside vernier render /tmp/study --view oblique --size 256x256 --out /tmp/inside.png --report /tmp/inside.json
inside vernier doctor --json >"$build/packages/doctor.json"
HOME=$root/tmp "$build/bin/vernier" render "$root/tmp/study" --view oblique --size 256x256 --engine native \
  --out "$root/tmp/outside.png" --report "$root/tmp/outside.json"
python3 - "$build" "$root/tmp" <<'PY'
import json, sys
build, tmp = sys.argv[1:]
packages = f"{build}/packages"
load = lambda p: json.load(open(p))
plugins = load(f"{packages}/plugins.json")["plugins"]
assert all(p["state"] == "loaded" for p in plugins), plugins
assert sorted(p["name"] for p in plugins) == sorted(open(f"{build}/packaging/plugins.txt").read().split()), plugins
doctor = load(f"{packages}/doctor.json")
assert doctor["native"]["available"] and not doctor["gl"]["available"], doctor["gl"]
assert "libosmesa6" in doctor["gl"]["why_not"], doctor["gl"]
assert not doctor["window"]["available"] and doctor["window"]["why_not"], doctor["window"]
inside, outside = load(f"{tmp}/inside.json"), load(f"{tmp}/outside.json")
assert inside["engine"]["name"] == "native", inside["engine"]
assert inside["image"]["sha256"] == outside["image"]["sha256"], (inside["image"], outside["image"])
assert inside["error"]["bound"] <= 2, inside["error"]
print(f"check: rendered without OpenGL, 99 % within {inside['error']['bound']:.2g} levels; plugins "
      + ", ".join(p["name"] for p in plugins))
PY
dpkg --root="$root" --log=/dev/null -P vernier >>"$build/packages/dpkg.log" 2>&1 || { cat "$build/packages/dpkg.log"; fail "dpkg -P"; }
rm -rf "${root:?}"/tmp/*
list >"$build/packages/after.txt"
diff "$build/packages/before.txt" "$build/packages/after.txt" || fail "removal left something behind, or took too much"
say "removal left nothing behind"
rm -f "$build"/packages/{before.txt,after.txt,plugins.json,doctor.json,dpkg.log}
