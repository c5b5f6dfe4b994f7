#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""sbom.py BUILD SBOM LICENCES VERSION: what Vernier is made of: CycloneDX 1.5 JSON, and the licence texts of all that is
compiled in.

Nothing here is a list kept by hand. Shared libraries are those that the built program, libvernier, the plugins and
what they load in turn really link (ldd); what is compiled in (headers, static libraries) is what the compiler and the
linker of BUILD really read. Each file is then looked up in Debian's package database, with its licences.
"""
import json
import os
import re
import subprocess
import sys
import uuid

OURS = re.compile(r"^(modules|app|ui|plugins|datasets-synthetic)/")
TOOLCHAIN = re.compile(r"^(libc6-dev|linux-libc-dev|libstdc\+\+-\d+-dev|libgcc-\d+-dev|gcc-\d+|g\+\+-\d+)$")


def run(*command, cwd=None):
    return subprocess.run(command, cwd=cwd, check=True, capture_output=True, text=True).stdout


def program_files(build):
    plugins = os.path.join(build, "lib/vernier/plugins")
    found = [os.path.join(build, "bin/vernier"), os.path.join(build, "lib/libvernier.so")]
    for folder, _, files in os.walk(os.path.join(build, "lib/vernier")):
        found += [os.path.join(folder, f) for f in files if f.endswith(".so")]
    assert os.path.isdir(plugins), plugins
    return [f for f in found if os.path.exists(f)]


def linked(build):
    libraries = set()
    for f in program_files(build):
        libraries |= set(re.findall(r"=> (/\S+) \(", run("ldd", f)))
    return {p for p in libraries if not os.path.realpath(p).startswith(os.path.realpath(build))}


def compiled_in(build):
    files, target = set(), ""
    for line in run("ninja", "-t", "deps", cwd=build).splitlines():
        if line and not line.startswith(" "):
            target = line.split(":")[0]
        elif OURS.match(target) and line.strip().startswith("/usr/"):
            files.add(line.strip())
    commands = run("ninja", "-t", "commands", "vernier_program", cwd=build)
    files |= set(re.findall(r"(/usr/[^\s\"';]+\.(?:a|ttf|otf))(?=[\s\"';]|$)", commands, re.M))
    if "/glad/src/gl.c" in commands:  # written by glad when the build is configured
        files.add("/usr/bin/glad")
    return files


def packages_of(files):
    """Package names by file; a file may be listed under its real path only (/usr/lib against /lib)."""
    names = set()
    files = sorted(files)
    for at in range(0, len(files), 200):
        part = files[at:at + 200]
        wanted = part + [os.path.realpath(f) for f in part]
        wanted += [f[4:] for f in wanted if f.startswith("/usr/lib")]
        said = subprocess.run(["dpkg-query", "-S", *wanted], capture_output=True, text=True).stdout
        for line in said.splitlines():
            if ": " in line and not line.startswith("diversion "):
                names |= {n.strip() for n in line.rsplit(": ", 1)[0].split(",")}
    return names


def licences(package):
    path = f"/usr/share/doc/{package.split(':')[0]}/copyright"
    if not os.path.exists(path):
        return []
    with open(path, encoding="utf-8", errors="replace") as f:
        text = f.read()
    found = {m.strip() for m in re.findall(r"(?m)^License:[ \t]*(\S.*)$", text)}
    found = found or set(re.findall(r"/usr/share/common-licenses/([A-Za-z0-9.+-]+[A-Za-z0-9])", text))
    return sorted(found) or ["see the package's copyright file"]


def component(package, how):
    version, arch, source = run("dpkg-query", "-W", "-f", "${Version}\t${Architecture}\t${source:Package}", package).split("\t")
    name = package.split(":")[0]
    return {
        "type": "library", "bom-ref": f"deb/{name}", "name": name, "version": version,
        "purl": f"pkg:deb/debian/{name}@{version}?arch={arch}&distro=debian-12",
        "licenses": [{"license": {"name": n}} for n in licences(package)],
        "properties": [{"name": "vernier:how", "value": how}, {"name": "debian:source", "value": source}],
    }


def write_licences(packages, out):
    with open(out, "w", encoding="utf-8") as f:
        f.write("Licences of what is compiled into Vernier beside its own code (Debian's copyright files).\n")
        for p in sorted(packages):
            path = f"/usr/share/doc/{p.split(':')[0]}/copyright"
            f.write(f"\n{'=' * 100}\n{p.split(':')[0]}\n{'=' * 100}\n")
            with open(path, encoding="utf-8", errors="replace") as text:
                f.write(text.read())


def main(build, out, licence_file, version):
    dynamic = packages_of(linked(build))
    static = {p for p in packages_of(compiled_in(build)) if not TOOLCHAIN.match(p.split(":")[0])}
    assert dynamic and static, "nothing was found: is BUILD built?"
    # A -dev package whose library is linked dynamically is told by the library itself; both are named.
    parts = [component(p, "linked") for p in sorted(dynamic)] + [component(p, "compiled in") for p in sorted(static - dynamic)]
    write_licences(static, licence_file)
    document = {
        "bomFormat": "CycloneDX", "specVersion": "1.5", "version": 1,
        "serialNumber": "urn:uuid:" + str(uuid.uuid5(uuid.NAMESPACE_OID, json.dumps(parts, sort_keys=True) + version)),
        "metadata": {"component": {"type": "application", "bom-ref": "vernier", "name": "vernier", "version": version,
                                   "licenses": [{"license": {"id": "GPL-3.0-or-later"}}]}},
        "components": parts,
        "dependencies": [{"ref": "vernier", "dependsOn": [p["bom-ref"] for p in parts]}],
    }
    with open(out, "w", encoding="utf-8") as f:
        json.dump(document, f, indent=1)
        f.write("\n")


if __name__ == "__main__":
    main(*sys.argv[1:])
