#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
# Run by scripts/wheel, in a root of Debian that has patchelf, pyelftools and a C compiler.
"""bundle_wheel.py TREE OUT: makes a wheel of what `cmake --install` put into TREE, with the shared libraries that it needs.

Each library goes to salbench/libs under a name with its digest, and is found there by its rpath: another of its name in the same
process is another library to the loader. Its copyright lies beside it. Prints the size and reason of each."""

import base64
import hashlib
import os
import re
import shutil
import subprocess
import sys
import tempfile
import tomllib
import zipfile
import zlib
from pathlib import Path

from elftools.elf.elffile import ELFFile

CHECKOUT = Path(__file__).resolve().parents[1]
# Those of manylinux's list (PEP 600) that ours need: every system has them.
OF_THE_SYSTEM = re.compile(r"(libc|libm|libdl|librt|libpthread|libresolv|libgcc_s|libstdc\+\+|libz|ld-linux-x86-64)\.so\.\d+")
# HDF5 calls these for files on Amazon's S3 alone, which salbench does not read. With them would come GnuTLS, Kerberos, LDAP, SSH ...
# In their place stand libraries of the same functions, which return 0.
ABSENT = re.compile(r"lib(curl|crypto)\.so\.\d+")


def run(*words: str | Path) -> str:
    return subprocess.run(words, check=True, stdout=subprocess.PIPE, text=True).stdout


def needed(file: Path) -> list[str]:
    with file.open("rb") as stream:
        names = [tag.needed for tag in ELFFile(stream).get_section_by_name(".dynamic").iter_tags("DT_NEEDED")]
    return [name for name in names if not OF_THE_SYSTEM.fullmatch(name)]


def stand_in(name: str, user: Path, folder: Path) -> Path:
    """A library with what the user takes from the one of that name, and its versions."""
    with user.open("rb") as stream:
        elf = ELFFile(stream)
        versions = {aux["vna_other"]: aux.name for library, parts in elf.get_section_by_name(".gnu.version_r").iter_versions()
                    for aux in parts if library.name == name}
        numbers = elf.get_section_by_name(".gnu.version")
        taken = [(versions.get(numbers.get_symbol(number)["ndx"]), symbol.name)
                 for number, symbol in enumerate(elf.get_section_by_name(".dynsym").iter_symbols())]
    symbols = {version: [symbol for of, symbol in taken if of == version] for version in versions.values()}
    code, script = folder / "absent.c", folder / "absent.map"
    code.write_text("".join(f"void *{symbol}(void) {{ return 0; }}\n" for each in symbols.values() for symbol in each))
    script.write_text("".join(f"{version} {{ global: {'; '.join(each)}; }};\n" for version, each in symbols.items()))
    run("cc", "-shared", "-fPIC", "-s", f"-Wl,-soname,{name},--version-script={script}", "-o", folder / name, code)
    return folder / name


def package_of(file: Path) -> str:
    """Debian's package of a file, whose folder may be below /usr or a link to there."""
    for path in (file, file.resolve(), Path("/usr") / file.resolve().relative_to("/")):
        found = subprocess.run(["dpkg", "-S", path], capture_output=True, text=True).stdout
        if found:
            return found.split(":")[0]
    sys.exit(f"{file}: is of no package, so its licence is unknown")


def packed(file: Path) -> int:
    return len(zlib.compress(file.read_bytes(), 9))


def find_beside(file: Path, libs: Path, names: dict[str, str]) -> None:
    """Makes a file take its libraries by their new names from libs. One change per call: Debian 12's patchelf mixes them up."""
    run("patchelf", *(word for name in needed(file) for word in ("--replace-needed", name, names[name])), file)
    run("patchelf", "--set-rpath", f"$ORIGIN/{os.path.relpath(libs, file.parent)}", file)
    lacking = [name for name in needed(file) if not (libs / name).is_file()]
    if lacking:
        sys.exit(f"{file}: needs {', '.join(lacking)}, which is not in the wheel")


def closure(files: list[Path], scratch: Path) -> tuple[dict[str, Path], dict[str, set[str]]]:
    """The file of each library that files need, and that libraries do; and what needs it."""
    places = dict(re.findall(r"^\s*(\S+) \(libc6,x86-64.*?\) => (\S+)$", run("/sbin/ldconfig", "-p"), re.MULTILINE))
    sources: dict[str, Path] = {}
    users: dict[str, set[str]] = {}
    todo = list(files)
    for file in todo:
        for name in needed(file):
            users.setdefault(name, set()).add(file.name.split(".")[0])
            if name not in sources:
                sources[name] = stand_in(name, file, scratch) if ABSENT.fullmatch(name) else Path(places[name])
                todo.append(sources[name])
    return sources, users


def bundle(tree: Path, scratch: Path) -> None:
    ours, libs = [*(tree / "salbench").glob("_core.*.so"), tree / "salbench/bin/salbench"], tree / "salbench/libs"
    sources, users = closure(ours, scratch)
    names = {name: re.sub(r"\.so", f"-{hashlib.sha256(source.read_bytes()).hexdigest()[:8]}.so", name, count=1)
             for name, source in sources.items()}
    packages = {name: package_of(source) for name, source in sources.items() if source.parent != scratch}
    (libs / "licences").mkdir(parents=True)
    for package in {"libjs-three", *packages.values()}:
        shutil.copyfile(f"/usr/share/doc/{package}/copyright", libs / "licences" / f"{package}.txt")
    rows = dict.fromkeys(ours, "")
    for name, source in sources.items():
        shutil.copyfile(source, libs / names[name])
        run("patchelf", "--set-soname", names[name], libs / names[name])
        rows[libs / names[name]] = f"; {packages.get(name, 'returns 0')}; for {', '.join(sorted(users[name]))}"
    for file in rows:
        find_beside(file, libs, names)
    print("KB packed  file; Debian's package")
    for file in sorted(rows, key=packed, reverse=True):
        print(f"{packed(file) / 1000:9.0f}  {file.name}{rows[file]}")


def metadata(project: dict, version: str) -> str:  # type: ignore[type-arg]  # of a TOML file
    lines = ["Metadata-Version: 2.1", f"Name: {project['name']}", f"Version: {version}", f"Summary: {project['description']}",
             f"License: {project['license']['text']}", f"Requires-Python: {project['requires-python']}"]
    lines += [f"Requires-Dist: {each}" for each in project["dependencies"]]
    for extra, each in project["optional-dependencies"].items():
        lines += [f"Provides-Extra: {extra}", *(f"Requires-Dist: {name}; extra == '{extra}'" for name in each)]
    return "\n".join([*lines, "Description-Content-Type: text/markdown", "", (CHECKOUT / project["readme"]).read_text()])


def pack(tree: Path, out: Path) -> Path:
    """Writes the wheel. The same tree gives the same bytes."""
    settings = tomllib.loads((CHECKOUT / "pyproject.toml").read_text())
    project, pattern = settings["project"], settings["tool"]["scikit-build"]["metadata"]["version"]["regex"]
    version = re.search(pattern, (CHECKOUT / "CMakeLists.txt").read_text())["value"]  # type: ignore[index]  # or else there is no project
    glibc = os.confstr("CS_GNU_LIBC_VERSION").split()[1].split(".")  # type: ignore[union-attr]  # it is glibc
    python = f"cp{sys.version_info.major}{sys.version_info.minor}"
    tag = f"{python}-{python}-manylinux_{'_'.join(glibc)}_x86_64"
    info = tree / f"salbench-{version}.dist-info"
    info.mkdir()
    (info / "METADATA").write_text(metadata(project, version))
    (info / "WHEEL").write_text(f"Wheel-Version: 1.0\nGenerator: bundle_wheel.py\nRoot-Is-Purelib: false\nTag: {tag}\n")
    (info / "entry_points.txt").write_text("[console_scripts]\n" + "".join(f"{name} = {of}\n" for name, of in project["scripts"].items()))
    shutil.copyfile(CHECKOUT / "LICENSE", info / "LICENSE")
    wheel = out / f"salbench-{version}-{tag}.whl"
    record = ""
    with zipfile.ZipFile(wheel, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as archive:
        def add(name: str, data: bytes, mode: int) -> None:
            entry = zipfile.ZipInfo(name)
            entry.compress_type, entry.external_attr = zipfile.ZIP_DEFLATED, (0o100000 | mode) << 16
            archive.writestr(entry, data)
        for file in sorted(file for file in tree.rglob("*") if file.is_file()):
            name, data = str(file.relative_to(tree)), file.read_bytes()
            add(name, data, 0o755 if os.access(file, os.X_OK) and file.parent.name == "bin" else 0o644)
            record += f"{name},sha256={base64.urlsafe_b64encode(hashlib.sha256(data).digest()).decode().rstrip('=')},{len(data)}\n"
        add(f"{info.name}/RECORD", f"{record}{info.name}/RECORD,,\n".encode(), 0o644)
    return wheel


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as folder:
        bundle(Path(sys.argv[1]), Path(folder))
    made = pack(Path(sys.argv[1]), Path(sys.argv[2]))
    with zipfile.ZipFile(made) as written:
        print(f"{made.name}: {made.stat().st_size / 1e6:.1f} MB, {len(written.namelist())} files")
