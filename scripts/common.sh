# SPDX-License-Identifier: GPL-3.0-or-later
# shellcheck shell=bash
# Sourced by other scripts, in the root of the checkout.

# usage: prints what a script says of itself above its line "set".
usage() { sed -n '3,/^set /s/^# \{0,1\}//p' "$0"; }

# passed WORDS: says it, with the seconds since the script began.
passed() { echo "$SECONDS s: $*"; }

# find_data: where no SALBENCH_DATA names a folder with SchellingData/ and reference/, it becomes the one beside the checkout, if
# there is one.
find_data() {
  [[ -z ${SALBENCH_DATA:-} && -f ../shared/data/unpack ]] || return 0
  SALBENCH_DATA=$(bash ../shared/data/unpack)
  export SALBENCH_DATA
}

# Fresh roots of Debian 12 and 13 below build/debian, made with debootstrap, which needs root. The first call fetches the base of a
# release from Debian's mirror, later ones copy it; packages that were installed in a root before are kept in archives-CODENAME. Two roots of
# different releases may install at the same time.

debian_mirror=${DEBIAN_MIRROR:-http://deb.debian.org/debian}
declare -A debian_codenames=([12]=bookworm [13]=trixie)

# debian_release: prints the number of the release that this machine runs.
debian_release() {
  local ID='' VERSION_ID='' PRETTY_NAME=unknown
  source /etc/os-release
  [[ $ID == debian && ${debian_codenames[$VERSION_ID]:-} ]] ||
    { echo "this system is $PRETTY_NAME, expected Debian ${!debian_codenames[*]}" >&2; return 1; }
  echo "$VERSION_ID"
}

# fresh_root NAME RELEASE: makes build/debian/NAME anew and prints its path.
fresh_root() {
  local folder=$PWD/build/debian base=base-$2
  mkdir -p "$folder"
  if [[ ! -d $folder/$base ]]; then
    rm -rf --one-file-system "$folder/$base.part"
    debootstrap --variant=minbase "${debian_codenames[$2]}" "$folder/$base.part" "$debian_mirror" > "$folder/debootstrap.log" 2>&1 ||
      { tail -n 5 "$folder/debootstrap.log" >&2; return 1; }
    echo force-unsafe-io > "$folder/$base.part/etc/dpkg/dpkg.cfg.d/unsafe-io"  # if the power fails, the root is made again
    mv "$folder/$base.part" "$folder/$base"
  fi
  rm -rf --one-file-system "${folder:?}/$1" "$folder/$1.part" &&
    cp -a --reflink=auto "$folder/$base" "$folder/$1.part" &&
    cp /etc/resolv.conf "$folder/$1.part/etc/resolv.conf" &&
    printf '127.0.0.1 localhost\n' > "$folder/$1.part/etc/hosts" &&  # an installed system has it, a bare root of Debian 12 not
    mv "$folder/$1.part" "$folder/$1" &&
    echo "$folder/$1"
}

# inside ROOT USER COMMAND...: runs a command in a root, with mounts and processes that end with it. USER: a number. A root with a
# folder /checkout has the checkout there, to read; /env is a virtual environment.
inside() {
  local root=$1 user=$2
  shift 2
  # shellcheck disable=SC2016  # the inner shell expands it
  unshare --mount --pid --fork --kill-child bash -c '
    mount --bind "$1" "$1" &&  # a root that is a mount lets a further root be entered from within
    archives=$(dirname "$1")/archives-$(sed -n "s/^VERSION_CODENAME=//p" "$1/etc/os-release") &&
    mkdir -p "$archives/partial" && mount --bind "$archives" "$1/var/cache/apt/archives" && mount -t proc proc "$1/proc" &&
    mount -t tmpfs tmpfs "$1/dev/shm" && mount -t devpts -o newinstance,ptmxmode=0666 devpts "$1/dev/pts" &&
    mount --rbind /sys "$1/sys" &&  # slurmd reads its groups of processes
    { [[ ! -d $1/checkout ]] || mount --bind -o ro . "$1/checkout"; } &&
    exec chroot --userspec="$2:$2" "$1" /usr/bin/env -i PATH=/env/bin:/usr/sbin:/usr/bin:/sbin:/bin HOME=/tmp LC_ALL=C.UTF-8 \
      DEBIAN_FRONTEND=noninteractive "${@:3}"' inside "$root" "$user" "$@"
}

need_root() { # NAME of the script
  [[ $(id -u) -eq 0 ]] || { echo "$1: needs root, for debootstrap and chroot" >&2; exit 1; }
}

# put_toy_data FOLDER: two small meshes, and a configuration that scores them and their scans against simulated participants.
put_toy_data() {
  rm -rf "$1"
  mkdir -p "$1"
  python3 scripts/toy_meshes.py "$1/meshes" 2 24 12
  printf 'dataset: {layout: folder, participants: simulated}\nscan: {step_degrees: 1}\n' > "$1/toy.yaml"
}

# run_toy ROOT: what a user does in a folder /work of a root, which is theirs: run twice, the second time with nothing to do.
run_toy() {
  put_toy_data "$1/work"
  chown -R 1000:1000 "$1/work"
  inside "$1" 1000 sh -euc 'cd /work && salbench run toy.yaml --data meshes --quiet'
  inside "$1" 1000 sh -euc 'cd /work && salbench run toy.yaml --data meshes'
  grep -x 'artefacts_computed: 0' "$1/work/salbench-out/toy/run.yaml" ||
    { echo "the second run computed something" >&2; return 1; }
  [[ -s $1/work/salbench-out/toy/results.csv ]]
}

# run_installed ROOT: what a user does with an installed program.
run_installed() {
  inside "$1" 1000 salbench --version
  run_toy "$1"
  inside "$1" 1000 sh -c 'cd / && salbench run shrec07_meshes --data /work/meshes --cache /work/by_name/cache --out /work/by_name --quiet'
  [[ -s $1/work/by_name/run.yaml ]]
  passed "runs from any folder; installed configurations are found by name"
}

# write_report ROOT: that of the toys' results.
write_report() {
  inside "$1" 1000 sh -c 'cd /work && salbench report salbench-out/toy > /dev/null'
  [[ -s $1/work/salbench-out/toy/report/index.html ]]
  passed "writes a report"
}

# run_python ROOT: what the package does there, in the user's Python.
run_python() {
  inside "$1" 1000 sh -c 'cd /work && PYTHONDONTWRITEBYTECODE=1 python3 -c "
import salbench
results = salbench.run(\"toy.yaml\", data=\"meshes\", cache=\"salbench-cache\", out=\"python\", progress=False)
assert len(results.scores) > 0 and not results.failures, results
assert results.report(\"python/report\").is_file()"'
  passed "Python imports the package, runs the benchmark and writes its report"
}

# Stage, key and content of what a cache holds, a line each. Which item came first, of several whose results are shared, and how long it
# took, is left out. Fails where there is nothing.
contents_of_cache() { # PACKAGE CACHE
  PYTHONPATH=$1 /usr/bin/python3 -B -P -c '
import sys, salbench
cache = salbench.Cache(sys.argv[1])
artefacts = [artefact.attributes for name in cache for stage in cache[name].stages for artefact in cache[name].all(stage)]
lines = sorted({f"{said['"'stage'"']} {said['"'key'"']} {said['"'content'"']}" for said in artefacts})
print(*lines, sep="\n")
sys.exit(not lines)' "$2"
}
