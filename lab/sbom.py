#!/usr/bin/env python3
"""Prints the software bill of materials of a package of this workspace, with all that it is built from, as CycloneDX 1.5.

    python3 lab/sbom.py srbf-capi > target/srbf-capi.cdx.json

Names, versions and licences come from `cargo metadata`, checksums from `Cargo.lock`. Dependencies of tests are left out.
"""

import json
import re
import subprocess
import sys
from pathlib import Path


def packages(name, metadata):
    """The package of that name and all that it is built from, as `cargo metadata` has them."""
    nodes = {node["id"]: node for node in metadata["resolve"]["nodes"]}
    by_id = {package["id"]: package for package in metadata["packages"]}
    roots = [package["id"] for package in by_id.values() if package["name"] == name and package["id"] in metadata["workspace_members"]]
    if not roots:
        sys.exit(f"{name}: no package of this workspace has that name")
    found, left = {}, roots
    while left:
        at = left.pop()
        needs = [d["pkg"] for d in nodes[at]["deps"] if any(kind["kind"] != "dev" for kind in d["dep_kinds"])]
        found[at] = sorted(needs)
        left += [need for need in needs if need not in found]
    return by_id, found


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    root = Path(__file__).resolve().parent.parent
    command = ["cargo", "metadata", "--locked", "--format-version", "1"]
    metadata = json.loads(subprocess.run(command, cwd=root, check=True, stdout=subprocess.PIPE).stdout)
    by_id, found = packages(sys.argv[1], metadata)
    lock = (root / "Cargo.lock").read_text()
    entries = re.findall(r'name = "(.+)"\nversion = "(.+)"\n(?:source = ".*"\nchecksum = "(.+)")?', lock)
    sums = {(name, version): checksum for name, version, checksum in entries}

    def reference(at):
        package = by_id[at]
        return f"pkg:cargo/{package['name']}@{package['version']}"

    def component(at):
        package = by_id[at]
        checksum = sums.get((package["name"], package["version"]))
        return {
            "type": "library",
            "bom-ref": reference(at),
            "name": package["name"],
            "version": package["version"],
            "purl": reference(at),
            "licenses": [{"expression": package["license"].replace("/", " OR ")}],
            **({"hashes": [{"alg": "SHA-256", "content": checksum}]} if checksum else {}),
        }

    everything = sorted(found, key=reference)
    print(json.dumps({
        "bomFormat": "CycloneDX",
        "specVersion": "1.5",
        "version": 1,
        "components": [component(at) for at in everything],
        "dependencies": [{"ref": reference(at), "dependsOn": sorted(map(reference, found[at]))} for at in everything],
    }, indent=1))


if __name__ == "__main__":
    main()
