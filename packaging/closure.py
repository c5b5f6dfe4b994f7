#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""closure.py FILE.deb [PACKAGE...]: the installed packages that the .deb and the packages depend on, all the way."""
import re
import subprocess
import sys


def run(*command):
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def alternatives(field):
    """[[name or its alternatives], ...] of a Depends field, without versions."""
    entries = [[re.sub(r"\(.*?\)|\[.*?\]|:\w+", "", a).strip() for a in e.split("|")] for e in field.split(",")]
    return [e for e in entries if e != [""]]


def main(deb, *extra):
    depends, provides = {}, {}
    for line in run("dpkg-query", "-W", "-f",
                    "${db:Status-Status}\t${Package}\t${Pre-Depends},${Depends}\t${Provides}\n").splitlines():
        status, name, needs, gives = line.split("\t")
        if status != "installed":
            continue
        depends[name] = alternatives(needs)
        for entry in alternatives(gives):
            provides.setdefault(entry[0], name)
    todo = alternatives(run("dpkg-deb", "-f", deb, "Depends")) + [[p] for p in extra]
    found = set()
    while todo:
        entry = todo.pop()
        name = next((n for n in entry if n in depends), None) or next((provides[n] for n in entry if n in provides), None)
        if name is None:
            sys.exit(f"closure.py: {' | '.join(entry)} is not installed here, so the clean room cannot be filled")
        if name not in found:
            found.add(name)
            todo += depends[name]
    print("\n".join(sorted(found)))


if __name__ == "__main__":
    main(*sys.argv[1:])
