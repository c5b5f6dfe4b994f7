#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Table 1 of Ropinski, Steinicke and Hinrichs 2005 again: three volumes of 256^3, with and without a neutral lens.

lens_table.py BENCH [--pairs 9] [--peer PROGRAM --work DIR] [--technique dvr.native]

BENCH is the built vernier_bench_lens, PROGRAM the peer's built vtk_peers, whose lens is a mask of labels; DIR takes the
volumes that it reads. Prints a Markdown table: frames in ms (medians and quartiles of interleaved pairs), the ratio pair
by pair, and with --peer the same of the peer. The paper's ratios are 1.03 to 1.53.
"""
import argparse
import json
import os
import pathlib
import shutil
import statistics
import subprocess


def lines(*command):
    out = subprocess.run([str(c) for c in command], check=True, capture_output=True, text=True).stdout
    return [json.loads(line) for line in out.splitlines() if line.startswith("{")]


def cell(quartiles, digits=3):
    low, median, high = quartiles
    return f"{median:.{digits}g} ({low:.{digits}g}..{high:.{digits}g})"


def quartiles(values):
    q = statistics.quantiles(values, n=4) if len(values) > 1 else [values[0]] * 3
    return q[0], statistics.median(values), q[2]


def peer(args, volume, edge):
    """The peer's frames without and with its mask: both in one run, run after run."""
    command = [args.peer, "--volume", args.work / f"{volume}.mhd", "--case", "dvr-gpu,dvr-lens-mask", "--size", f"{edge}x{edge}",
               "--frames", args.peer_frames, "--out", args.work]
    if not os.environ.get("DISPLAY"):
        command = ["xvfb-run", "-a", "-s", "-screen 0 1200x1200x24 -noreset", *command]
    plain, mask = [], []
    for _ in range(args.pairs):
        of = {line["case"]: line["median_ms"] for line in lines(*command)}
        plain.append(of["dvr-gpu"])
        mask.append(of["dvr-lens-mask"])
    return f"{cell(quartiles(plain))} | {cell(quartiles(mask))} | {cell(quartiles([m / p for m, p in zip(mask, plain)]))}"


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("bench", type=pathlib.Path)
    p.add_argument("--pairs", type=int, default=9)
    p.add_argument("--technique", default="dvr.native")
    p.add_argument("--peer", type=pathlib.Path)
    p.add_argument("--peer-frames", type=int, default=3)
    p.add_argument("--work", type=pathlib.Path, default=pathlib.Path("out/bench"))
    args = p.parse_args()
    if args.peer and not os.environ.get("DISPLAY") and not shutil.which("xvfb-run"):
        p.error("the peer draws on a display, and there is none; install xvfb or set DISPLAY")
    if args.peer:
        args.work.mkdir(parents=True, exist_ok=True)
        lines(args.bench, "write", args.work)
    head = "| volume, 256^3 | picture | plain, ms | with a lens, ms | ratio | samples, ratio | largest difference of 255 |"
    print(head + (" peer plain, ms | peer with its mask, ms | ratio |" if args.peer else ""))
    print("|---" * (10 if args.peer else 7) + "|")
    for row in lines(args.bench, "table", args.pairs, args.technique):
        text = (f"| {row['volume']} | {row['edge_px']}x{row['edge_px']} | {cell(row['plain_ms'])} | {cell(row['lens_ms'])} "
                f"| {cell(row['ratio'])} | {row['samples_ratio']:.5f} | {row['largest_difference']:.2g} |")
        print(text + (f" {peer(args, row['volume'], row['edge_px'])} |" if args.peer else ""), flush=True)


if __name__ == "__main__":
    main()
