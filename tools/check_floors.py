#!/usr/bin/env python3
"""Fails on an include that goes up or sideways in the house (src/normalshop/README.md).

Usage: check_floors.py [ROOT]

Checks every C++ file below src/normalshop, apps, examples, fuzz and benchmarks:
- a floor includes itself and the floors that the table allows;
- a third-party header stays in the .cpp files of the floor that owns it;
- an app includes floors and itself, never another app.
Files and headers that are too long are reported as warnings.
"""

import pathlib
import re
import sys

FLOORS = {
    "core": set(),
    "rgbn": {"core"},
    "surface": {"core"},
    "chart": {"core", "rgbn", "surface"},
    "capture": {"core", "rgbn", "surface"},
    "document": {"core", "rgbn", "surface", "chart", "capture"},
    "io": {"core", "rgbn", "surface", "capture", "document"},
}

# Header prefix -> floors whose .cpp files may include it. Eigen may go everywhere.
EVERY_FLOOR = set(FLOORS)
THIRD_PARTY = {
    "tbb/": {"core"},
    "oneapi/": {"core"},
    "hwy/": EVERY_FLOOR,
    "nanoflann": {"rgbn"},
    "ft2build.h": {"io"},
    "freetype/": {"io"},
    "embree": {"surface"},
    "nlohmann/": {"document", "io"},
    "sqlite3.h": {"document"},
    "zstd.h": {"document"},
    "OpenImageIO/": {"io"},
    "OpenEXR/": {"io"},
    "tiny_obj_loader.h": {"io"},
    "CLI/": set(),
    "Q": set(),
    "zlib.h": {"io"},
}

INCLUDE = re.compile(r'^\s*#\s*include\s*[<"]([^>"]+)[>"]')
LONGEST = {".cpp": 400, ".h": 150}


def owner_of(header):
    """The entry of THIRD_PARTY that a header belongs to, or None."""
    return next((prefix for prefix in THIRD_PARTY if header.startswith(prefix)), None)


def floor_error(floor, path, header):
    """Why a file of a floor may not include a header; None when it may."""
    if header.startswith("normalshop/"):
        other = header.split("/")[1]
        if other not in FLOORS:
            return f"'{other}' is no floor"
        if other != floor and other not in FLOORS[floor]:
            return f"floor '{floor}' may not include floor '{other}'"
        if other != floor and "/detail/" in header:
            return f"headers in detail/ are for floor '{other}' alone"
        return None
    prefix = owner_of(header)
    if prefix is None:
        return None
    if floor not in THIRD_PARTY[prefix]:
        return f"floor '{floor}' does not own this library"
    if path.suffix == ".h" and path.parent.name != "detail":
        return "third-party headers stay inside .cpp files and detail/"
    return None


def app_error(app, apps, header):
    """Why a file of an app may not include a header; None when it may."""
    first = header.split("/")[1 if header.startswith("apps/") else 0]
    if first in apps and first != app:
        return f"app '{app}' may not include app '{first}'"
    return None


def sources(folder):
    return sorted(p for p in folder.rglob("*") if p.suffix in LONGEST) if folder.is_dir() else []


def check_file(path, error_of, errors, warnings):
    lines = path.read_text(encoding="utf-8").splitlines()
    if len(lines) > LONGEST[path.suffix]:
        warnings.append(f"{path}: {len(lines)} lines; {LONGEST[path.suffix]} is the limit")
    for number, line in enumerate(lines, 1):
        found = INCLUDE.match(line)
        error = error_of(found.group(1)) if found else None
        if error:
            errors.append(f"{path}:{number}: {found.group(1)}: {error}")


def check(root):
    errors, warnings = [], []
    house = root / "src" / "normalshop"
    if not house.is_dir():
        return [f"{house}: there is no such folder"], []
    for path in sources(house):
        floor = path.relative_to(house).parts[0]
        if floor in FLOORS:
            check_file(path, lambda h, f=floor, p=path: floor_error(f, p, h), errors, warnings)
        else:
            errors.append(f"{path}: belongs to no floor")
    apps = {p.name for p in (root / "apps").iterdir()} if (root / "apps").is_dir() else set()
    for path in sources(root / "apps"):
        app = path.relative_to(root / "apps").parts[0]
        check_file(path, lambda h, a=app: app_error(a, apps, h), errors, warnings)
    for part in ("examples", "fuzz", "benchmarks"):
        for path in sources(root / part):
            check_file(path, lambda h: app_error(None, apps, h), errors, warnings)
    return errors, warnings


def main():
    root = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else pathlib.Path(__file__).parent.parent
    errors, warnings = check(root.resolve())
    for line in warnings:
        print("warning:", line)
    for line in errors:
        print("error:", line)
    return 1 if errors else 0


if __name__ == "__main__":
    sys.exit(main())
