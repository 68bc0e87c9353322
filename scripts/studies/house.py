# SPDX-License-Identifier: GPL-3.0-or-later
# Run by scripts/figures house.
"""The folders of the source code in figures: lines, types, and which other folders each includes."""

import re
from collections import Counter, defaultdict

from studies.common import ROOT, markdown, show

SHARED = ("core", "geometry", "descriptors")  # folders of stages/ that all other stages may include
PACKAGE = "python/salbench/"
LOOSE = ("tests", "scripts", "docs", "cmake", "configs", "models")  # include what they like
FOLDERS = ("cache", "io", "pipeline", "python", "stages", *LOOSE)
TYPE = {
    "cpp": re.compile(r"^ *(?:template <.*> *)?(?:struct|class|enum class|enum) \w[^;()=]*\{", re.M),
    "py": re.compile(r"^ *class \w", re.M),
}
INCLUDE = {
    "cpp": re.compile(r'^#include "((?:stages|io|cache|pipeline)/[^"]*)"', re.M),
    "py": re.compile(r"^ *(?:from|import) salbench\.(\w+)", re.M),
}


def house(write):
    lines, types, included = Counter(), Counter(), defaultdict(set)
    for file in sorted(file for folder in FOLDERS for file in (ROOT / folder).rglob("*") if file.is_file()):
        path = file.relative_to(ROOT).as_posix()
        room = room_of(path)
        try:
            text = file.read_text(encoding="utf-8")
        except UnicodeDecodeError:  # pictures, archives, bytecode
            continue
        lines[room] += text.count("\n")
        language = "py" if path.endswith((".py", ".pyi")) else "cpp" if path.endswith((".h", ".cpp")) else ""
        if language and room not in LOOSE:
            types[room] += len(TYPE[language].findall(text))
            included[room].update(map(room_of_include, INCLUDE[language].findall(text)))
    rows = [
        (
            f"`{room}`",
            f"{lines[room]:,}",
            str(types.get(room, "")),
            ", ".join(f"`{other.removeprefix(PACKAGE)}`" for other in sorted(included[room] - {room, ""})),
        )
        for room in sorted(lines, key=lambda room: (room in LOOSE, room))
    ]
    show(markdown(("folder", "lines", "types", "includes"), rows), ROOT / "CONTRIBUTING.md", "house", write)


def room_of(path):
    """Row of a file."""
    first, *others = path.split("/")[:-1]
    if path.startswith(PACKAGE):
        return PACKAGE + "".join(others[1:2])
    if first == "stages" and others:
        return f"stages/{others[0]}" if others[0] in SHARED else "stages/*"
    if first == "pipeline" and others:
        return f"pipeline/{others[0]}"
    return first


def room_of_include(name):
    if "/" in name:
        return room_of(name)
    return PACKAGE + name if (ROOT / PACKAGE / name).is_dir() else ""
