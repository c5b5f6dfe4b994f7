#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Slices and loading against a peer program, in one run: A B A B ..., ratios pair by pair.

peers.py VERNIER PEER_BUILD WORK_DIR [--pairs 9] [--frames 60]

PEER_BUILD holds the built peer programs vtk_peers, make_phantoms and dicom_load. Prints a Markdown table: medians and
quartiles of both, the ratio with its quartiles, and the measured error of our picture beside its time.
"""
import argparse
import json
import pathlib
import statistics
import subprocess


def run(*command):
    return subprocess.run([str(c) for c in command], check=True, capture_output=True, text=True).stdout


def last_json(text):
    return json.loads([line for line in text.splitlines() if line.startswith("{")][-1])


def quartiles(values):
    q = statistics.quantiles(values, n=4) if len(values) > 1 else [values[0]] * 3
    return statistics.median(values), q[0], q[2]


def cell(values):
    median, low, high = quartiles(values)
    return f"{median:.3g} ({low:.3g}..{high:.3g})"


def slices(args, volume, view, peer_case, extra):
    ours, theirs, error = [], [], None
    for _ in range(args.pairs):
        a = last_json(run(args.vernier, "bench", volume, "--view", view, "--size", "512x512", "--engine", "native",
                          "--window", "500,1400", "--quality", "draft", "--frames", args.frames, *extra))
        b = last_json(run(args.peer / "vtk_peers", "--volume", volume, "--case", peer_case, "--frames", args.frames,
                          "--out", args.work))
        ours.append(a["median_ms"])
        theirs.append(b["median_ms"])
        error = a["error"]
    ratio = [t / o for o, t in zip(ours, theirs)]
    return (f"| {volume.stem} {view} {' '.join(extra)} | {cell(ours)} | {peer_case} {cell(theirs)} | {cell(ratio)} "
            f"| {error['bound']:.2g} / {error['max']:.2g} |")


def loading(args, folder):
    ours, theirs, peak = [], [], 0
    for _ in range(args.pairs):
        a = last_json(run(args.vernier, "bench", folder, "--view", "axial", "--frames", "1", "--loads", "3", "--no-error"))
        text = run(args.peer / "dicom_load", "read", folder, "3")
        b = next(json.loads(line) for line in text.splitlines() if "vtkDICOMImageReader" in line and "warm" in line)
        ours.append(a["load_ms"])
        theirs.append(b["median_ms"])
        peak = max(peak, a["peak_rss_mb"])
        volume_mb = a["dims"][0] * a["dims"][1] * a["dims"][2] * 2 / 1048576
    ratio = [t / o for o, t in zip(ours, theirs)]
    return (f"| load {len(list(folder.iterdir()))} files, warm | {cell(ours)} | vtkDICOMImageReader {cell(theirs)} | {cell(ratio)} "
            f"| peak {peak:.0f} MB, volume {volume_mb:.0f} MB, limit {1.3 * volume_mb + 100:.0f} MB |")


def main():
    p = argparse.ArgumentParser()
    p.add_argument("vernier", type=pathlib.Path)
    p.add_argument("peer", type=pathlib.Path)
    p.add_argument("work", type=pathlib.Path)
    p.add_argument("--pairs", type=int, default=9)
    p.add_argument("--frames", type=int, default=60)
    args = p.parse_args()
    args.work.mkdir(parents=True, exist_ok=True)
    if not (args.work / "ctHead512.mhd").exists():
        run(args.peer / "make_phantoms", args.work)
    series = args.work / "ctHead512-dicom"
    if not series.exists():
        series.mkdir()
        run(args.peer / "dicom_load", "write", args.work / "ctHead512.mhd", series)
    print("| case | vernier, ms: median (quartiles) | peer, ms | peer / vernier | error of 255: bound / max |")
    print("|---|---|---|---|---|")
    for name in ("ctHead512", "vessels256"):
        volume = args.work / f"{name}.mhd"
        print(slices(args, volume, "axial", "mpr-axial-wl", []), flush=True)
        print(slices(args, volume, "oblique", "mpr-oblique-wl", []), flush=True)
        print(slices(args, volume, "slab", "mpr-slab-mip", ["--slab", "10"]), flush=True)
    print(loading(args, series), flush=True)


if __name__ == "__main__":
    main()
