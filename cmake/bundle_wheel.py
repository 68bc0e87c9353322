#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
# Run by scripts/wheel, in a root of Debian that has patchelf, binutils, python3-wheel and a C compiler.
"""bundle_wheel.py TREE OUT: makes a wheel of the files that `cmake --install` put into TREE, with the shared
libraries that they need.

Each library goes to salbench/libs under a name with its digest, and is found by rpath, so it does not clash
with another of its name in the same process. Its copyright file is beside it. Prints the packed size of each,
and its package.
"""

import hashlib
import os
import re
import shutil
import subprocess
import sys
import tempfile
import tomllib
import zlib
from pathlib import Path

CHECKOUT = Path(__file__).resolve().parents[1]
# Required libraries on manylinux's list (PEP 600), which every system has.
OF_THE_SYSTEM = re.compile(
    r"(libc|libm|libdl|librt|libpthread|libresolv|libgcc_s|libstdc\+\+|libz|ld-linux-x86-64)\.so\.\d+"
)
# HDF5 calls these only for files on Amazon S3, which salbench does not read. Their dependencies include
# GnuTLS, Kerberos, LDAP and SSH. They are replaced by stubs of the same functions, which return 0.
ABSENT = {"libcurl": "CURL", "libcrypto": "OPENSSL"}


def run(*words: str | Path, **more: str) -> str:
    return subprocess.run(words, check=True, stdout=subprocess.PIPE, text=True, env=os.environ | more).stdout


def needed(file: Path) -> list[str]:
    return [
        name for name in run("patchelf", "--print-needed", file).split() if not OF_THE_SYSTEM.fullmatch(name)
    ]


def stand_in(name: str, versions: str, user: Path, folder: Path) -> Path:
    """Builds a stub library with the functions that the user takes from the named one, with their
    versions."""
    taken = re.findall(rf" U (\w+)@({versions}\w*[.\w]*)", run("nm", "-D", user))
    code, script = folder / "absent.c", folder / "absent.map"
    code.write_text("".join(f"void *{symbol}(void) {{ return 0; }}\n" for symbol, _ in taken))
    script.write_text(
        "".join(
            f"{version} {{ global: {' '.join(f'{symbol};' for symbol, of in taken if of == version)} }};\n"
            for version in sorted({version for _, version in taken})
        )
    )
    run(
        "cc",
        "-shared",
        "-fPIC",
        "-s",
        f"-Wl,-soname,{name},--version-script={script}",
        "-o",
        folder / name,
        code,
    )
    return folder / name


def module_of(tree: Path) -> Path:
    return next((tree / "salbench").glob("_core.cpython-*.so"))


def closure(files: list[Path], scratch: Path) -> dict[str, Path]:
    """Maps each library that the files need, directly or indirectly, to its file."""
    places = dict(
        re.findall(r"^\s*(\S+) \(libc6,x86-64.*?\) => (\S+)$", run("/sbin/ldconfig", "-p"), re.MULTILINE)
    )
    sources: dict[str, Path] = {}
    todo = list(files)
    for file in todo:
        for name in needed(file):
            if name not in sources:
                absent = ABSENT.get(name.split(".")[0])
                sources[name] = stand_in(name, absent, file, scratch) if absent else Path(places[name])
                todo.append(sources[name])
    return sources


def bundle(tree: Path, scratch: Path) -> None:
    libs, rows = tree / "salbench/libs", {}
    sources = closure(ours := [module_of(tree)], scratch)
    names = {
        name: name.replace(".so", f"-{hashlib.sha256(source.read_bytes()).hexdigest()[:8]}.so", 1)
        for name, source in sources.items()
    }
    (libs / "licences").mkdir(parents=True)
    shutil.copyfile("/usr/share/doc/libjs-three/copyright", libs / "licences/libjs-three.txt")
    for name, source in sources.items():
        package = "returns 0"
        if source.parent != scratch:
            # its folder may be a link
            package = run("dpkg", "-S", f"*/{source.resolve().name}").split(":")[0]
            shutil.copyfile(f"/usr/share/doc/{package}/copyright", libs / "licences" / f"{package}.txt")
        shutil.copyfile(source, libs / names[name])
        run("patchelf", "--set-soname", names[name], libs / names[name])
        rows[libs / names[name]] = package
    for file in [*ours, *rows]:  # one change per call, because Debian 12's patchelf corrupts combined changes
        run(
            "patchelf",
            *(word for name in needed(file) for word in ("--replace-needed", name, names[name])),
            file,
        )
        run("patchelf", "--set-rpath", f"$ORIGIN/{os.path.relpath(libs, file.parent)}", file)
        assert all(
            (libs / name).is_file() for name in needed(file)
        ), f"{file}: needs a library that is not in the wheel"
    print("KB packed  file; Debian's package")
    for size, file in sorted(
        ((len(zlib.compress(file.read_bytes(), 9)), file) for file in [*ours, *rows]), reverse=True
    ):
        print(f"{size / 1000:9.0f}  {file.name}; {rows.get(file, 'salbench')}")


def describe(tree: Path) -> None:
    settings = tomllib.loads((CHECKOUT / "pyproject.toml").read_text())
    project, pattern = settings["project"], settings["tool"]["scikit-build"]["metadata"]["version"]["regex"]
    version = re.search(pattern, (CHECKOUT / "CMakeLists.txt").read_text())["value"]  # type: ignore[index]  # or else there is no project
    glibc = os.confstr("CS_GNU_LIBC_VERSION").split()[1].split(".")  # type: ignore[union-attr]  # it is glibc
    python = "cp" + re.findall(r"cpython-(\d+)-", module_of(tree).name)[0]
    lines = [
        "Metadata-Version: 2.1",
        f"Name: {project['name']}",
        f"Version: {version}",
        f"Summary: {project['description']}",
        f"License: {project['license']['text']}",
        f"Requires-Python: {project['requires-python']}",
    ]
    lines += [f"Requires-Dist: {each}" for each in project["dependencies"]]
    for extra, each in project["optional-dependencies"].items():
        lines += [
            f"Provides-Extra: {extra}",
            *(f"Requires-Dist: {name}; extra == '{extra}'" for name in each),
        ]
    lines += ["Description-Content-Type: text/markdown", "", (CHECKOUT / project["readme"]).read_text()]
    info = tree / f"salbench-{version}.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("\n".join(lines))
    (info / "WHEEL").write_text(
        "Wheel-Version: 1.0\nGenerator: bundle_wheel.py\nRoot-Is-Purelib: false\n"
        f"Tag: {python}-{python}-manylinux_{'_'.join(glibc)}_x86_64\n"
    )
    (info / "entry_points.txt").write_text(
        "[console_scripts]\n" + "".join(f"{name} = {of}\n" for name, of in project["scripts"].items())
    )
    shutil.copyfile(CHECKOUT / "LICENSE", info / "LICENSE")


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as folder:
        bundle(Path(sys.argv[1]), Path(folder))
    describe(Path(sys.argv[1]))
    # A single date for all files makes the wheel reproducible.
    print(
        run(
            sys.executable,
            "-m",
            "wheel",
            "pack",
            sys.argv[1],
            "--dest-dir",
            sys.argv[2],
            SOURCE_DATE_EPOCH="315532800",
        ),
        end="",
    )
