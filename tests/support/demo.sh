#!/usr/bin/env bash
# demo.sh VERNIER [STUDY]: loads a study through the real loader and writes contact sheets of its slices, each picture
# with its time and its measured error, to out/demo.
set -euo pipefail
cd "$(dirname "$0")/../.."
vernier=$1
study=${2:-}
out=out/demo
mkdir -p "$out"

say() { printf '\n%s\n' "$*"; }

say "A synthetic head (512x512x256, CT), written as DICOM:"
[ -d "$out/ct-head" ] || "$vernier" phantom ct-head --out "$out"

if [ -z "$study" ] && [ -d ../shared/data/ct_phantom_head_series ]; then study=../shared/data/ct_phantom_head_series; fi
if [ -n "$study" ]; then
  say "The real study:"
  "$vernier" info "$study"
  "$vernier" sheet "$study" --out "$out/contact-sheet.png" --title "real study"
else
  say "No study was named; the synthetic one alone is shown. Give a folder: ./dev demo PATH"
fi
"$vernier" info "$out/ct-head"
# The path follows the jaw from one side to the other, through the roots of the teeth.
arch="-38,-20,-88;-29,-45,-88;-18,-70,-88;0,-80,-88;18,-70,-88;29,-45,-88;38,-20,-88"
"$vernier" sheet "$out/ct-head" --out "$out/contact-sheet-synthetic.png" --title "synthetic head" --preset brain \
  --columns 4 --views stack,axial,coronal,sagittal,oblique,oblique:cubic,slab,curved --path "$arch" --form stretched \
  --width 70
[ -n "$study" ] || cp "$out/contact-sheet-synthetic.png" "$out/contact-sheet.png"

say "Looks through volumes: projections, emission shells, and a tool among them:"
"$vernier" phantom vessels --out "$out" >/dev/null
screw=../shared/data/surf_pedicle_screw/D4.5L30.stl
if [ ! -f "$screw" ]; then
  "$vernier" phantom screw --out "$out" >/dev/null
  screw=$out/screw.stl
fi
levels=260,340,420,500,580,660  # above the tissue and its noise
angio=$out/vessels
looks=mip,mip:cued,minip,mean,sum,shells,shells:cued,shells-sum,shells-lit,attenuation
if [ -d ../shared/data/vol_cta_avm ]; then angio=../shared/data/vol_cta_avm/AVM.nii.gz; fi
for projection in orthographic perspective; do
  "$vernier" sheet "$out/vessels" --out "$out/looks-$projection.png" --title "vessels, $projection" --columns 5 \
    --size 384x384 --views "$looks" --levels "$levels" \
    --camera "azimuth=30,elevation=20,zoom=1.4,projection=$projection"
  "$vernier" sheet "$out/vessels" --out "$out/looks-tool-$projection.png" --title "vessels and a screw, $projection" \
    --columns 5 --size 384x384 --views "$looks" --levels "$levels" --surface "$screw" \
    --camera "azimuth=30,elevation=20,zoom=1.4,projection=$projection"
  [ "$angio" = "$out/vessels" ] ||
    "$vernier" sheet "$angio" --out "$out/looks-angiography-$projection.png" --title "CT angiography, $projection" \
      --columns 5 --size 384x384 --views "$looks" --camera "azimuth=30,elevation=20,zoom=1.4,projection=$projection"
done

say "Volume rendering: by a transfer function, shaded in two ways, iso-surfaces, a tool inside, colours:"
dvr=dvr,dvr-shaded,dvr-shaded:global-ambient,iso,iso:two-lights
"$vernier" sheet "$out/ct-head" --out "$out/dvr-head.png" --title "synthetic head" --columns 5 --size 384x384 --views "$dvr" \
  --camera azimuth=30,elevation=20,zoom=1.3
"$vernier" sheet "$out/vessels" --out "$out/dvr-tool.png" --title "vessels and a screw" --columns 5 --size 384x384 \
  --views "$dvr" --surface "$screw" --camera azimuth=30,elevation=20,zoom=1.4
"$vernier" phantom rgba-spheres --format mha --out "$out/rgba" >/dev/null
"$vernier" sheet "$out/rgba" --out "$out/dvr-colours.png" --title "red, green, blue and alpha" --columns 3 \
  --size 384x384 --views dvr,dvr:dvr.slabs,dvr:nearest --gains 1,1,1,0.4 --camera azimuth=30,elevation=20
for real in vol_mr_t1_brain vol_engine vol_cta_avm; do
  [ -d "../shared/data/$real" ] || continue
  "$vernier" sheet "../shared/data/$real" --out "$out/dvr-$real.png" --title "$real" --columns 5 --size 384x384 \
    --views "$dvr" --camera azimuth=30,elevation=20,zoom=1.3
done

say "The same picture by every technique:"
"$vernier" sheet "$out/vessels" --out "$out/dvr-techniques.png" --title "one picture, every technique" --columns 4 \
  --size 256x256 --camera azimuth=30,elevation=20,zoom=1.4 \
  --views "dvr:dvr.native+x1,dvr:dvr.native+x4,dvr:dvr.rays+x1,dvr:dvr.stacks+x1,dvr:dvr.stacks+x2,dvr:dvr.stacks+x4,dvr:dvr.stacks2+x1,dvr:dvr.slabs+x1"

say "Lenses: bone in the head, a piece cut out, a way from the skin to its target, vessels, a screw, a slice:"
camera=azimuth=30,elevation=20,zoom=1.3
"$vernier" sheet "$out/ct-head" --out "$out/lens-bone.png" --title "bone in a lens" --columns 2 --size 384x384 \
  --views dvr,dvr-shaded --lens sphere:45,-85,30,45 --lens-inner iso --camera "$camera"
"$vernier" sheet "$out/ct-head" --out "$out/lens-cut.png" --title "a piece cut out" --columns 2 --size 384x384 \
  --views dvr-shaded,iso --lens sphere:40,-80,40,45 --lens-inner cut-out --camera "$camera"
"$vernier" sheet "$out/ct-head" --out "$out/lens-way.png" --title "from the skin to the target" --columns 2 \
  --size 384x384 --views dvr-shaded,mip --lens cone:60,-110,60,0,0,0,25,2 --lens-inner cut-out --camera "$camera"
"$vernier" sheet "$out/ct-head" --out "$out/lens-slice.png" --title "another window in a lens" --columns 3 \
  --size 384x384 --preset brain --views axial,coronal,sagittal --lens sphere:0,-60,0,35 --lens-inner bone
"$vernier" sheet "$out/vessels" --out "$out/lens-vessels.png" --title "vessels: rendered in a lens" --columns 3 \
  --size 384x384 --views mip,sum,dvr --lens sphere:0,0,0,20 --camera azimuth=30,elevation=20,zoom=1.4
"$vernier" sheet "$out/vessels" --out "$out/lens-screw.png" --title "a screw in a cut-out" --columns 2 --size 384x384 \
  --views dvr,mip --surface "$screw" --lens sphere:0,0,0,30 --lens-inner cut-out \
  --camera azimuth=30,elevation=20,zoom=1.4
if [ -d ../shared/data/vol_engine ]; then
  "$vernier" sheet ../shared/data/vol_engine --out "$out/lens-engine.png" --title "an engine, looked into" --columns 2 \
    --size 384x384 --views dvr,dvr-shaded --lens box:40,-40,20,110,110,100 --lens-inner iso:180 --camera "$camera"
fi

say "Broken series load too; what is wrong is said:"
for broken in tilt gap uneven; do
  "$vernier" phantom "$broken" --out "$out" >/dev/null
  "$vernier" sheet "$out/$broken" --out "$out/sheet-$broken.png" --title "$broken" --size 256x256
done

say "What one picture needs, and why (--explain):"
"$vernier" render "$out/ct-head" --view oblique --preset bone --explain --out "$out/oblique.png"
say "Is this installation right? Every case has an answer that is known beforehand:"
"$vernier" qa run clinic --out "$out/clinic" | tail -n 2
say "Look at $out/clinic/report.html, $out/contact-sheet.png and the other sheets beside it."
if [ -n "${DISPLAY:-}${WAYLAND_DISPLAY:-}" ] && [ -t 1 ]; then
  say "The window (close it to end; F1 shows mouse and keys):"
  "$vernier" view "${study:-$out/ct-head}"
fi
