#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# layers.sh ROOT: the folders are the layers, and includes go one way. Names every include that does not.
set -euo pipefail
cd "$1"
breaches=0

# path:line:included of every include of the program's sources; tests may include what they like, but for those of the engine.
includes() {
  local folder
  for folder in stages io cache pipeline python tests/engine; do
    [[ -d $folder ]] && grep -rnoE --include='*.h' --include='*.cpp' '^#include [<"][^>"]+[>"]' "$folder"
  done | sed -E 's/#include [<"]([^>"]+)[>"]/\1/'
}

complain() { # path:line included why
  echo "$1: includes $2: $3"
  breaches=$((breaches + 1))
}

# keeps FOLDER ALLOWED: files in FOLDER include, of our own, only what matches ALLOWED.
keeps() {
  local where included
  while IFS=: read -r path line included; do
    where=$path:$line
    [[ $path == $1/* && $included =~ ^(stages|io|cache|pipeline|tests)/ ]] || continue
    [[ $included =~ ^($2)/ ]] || complain "$where" "$included" "$1 may include $2 only"
  done < <(includes)
}

# hides LIBRARY HEADERS [HOME]: what matches HEADERS is included by one .cpp and by no header, or by HOME alone.
hides() {
  local path line included home=${3:-}
  while IFS=: read -r path line included; do
    [[ $included =~ ^($2) ]] || continue
    [[ $path == *.cpp || $path == "$home" ]] || complain "$path:$line" "$included" "$1 belongs in a .cpp"
    [[ -z $home || $home == "$path" ]] || complain "$path:$line" "$included" "$1 is already included by $home"
    home=$path
  done < <(includes)
}

shared=''
for room in core geometry descriptors; do
  shared+="${shared:+|}stages/$room"
  keeps "stages/$room" "$shared"
done
for folder in stages/*/; do
  folder=${folder%/}
  [[ $folder =~ ^($shared)$ ]] || keeps "$folder" "$shared|$folder"
done
keeps io 'io|stages/core|stages/geometry'
keeps cache 'cache|io|stages/core'
below='cache|io|stages/[a-z_]+'
for room in config engine inputs rules results run; do
  below+="|pipeline/$room"
  keeps "pipeline/$room" "$below"
done
subject_free='^(pipeline/engine/|cache/|io/(arrays|digest|file)\.h|stages/core/(errors|parallel|progress|rng)\.h)'
while IFS=: read -r path line included; do
  [[ ! $path =~ ^(pipeline|tests)/engine/ || ! $included =~ ^(stages|io|pipeline)/ || $included =~ $subject_free ]] ||
    complain "$path:$line" "$included" "the engine and its tests know nothing of shapes"
done < <(includes)
while IFS=: read -r path line included; do
  [[ ! $path =~ ^pipeline/[^/]+$ ]] || complain "$path:$line" "$included" "pipeline has rooms: put it into one"
done < <(includes)

hides CGAL 'CGAL/'
hides Embree 'embree[34]/' stages/geometry/embree.cpp
hides HDF5 'hdf5\.|H5' io/hdf5/hdf5_library.h
hides PCL 'pcl/'
hides Spectra 'Spectra/'
hides 'the flow graph' '(tbb|oneapi/tbb)/flow_graph'
hides xxHash 'xxhash'

while IFS=: read -r path line included; do
  [[ $included != io/hdf5/hdf5_library.h || $path == io/hdf5/hdf5_* ]] ||
    complain "$path:$line" "$included" "it brings the HDF5 library with it"
done < <(includes)

while IFS=: read -r path line included; do  # one file reads it, one writes it
  [[ $included != yaml-cpp/* || $path == pipeline/config/*.cpp ]] ||
    complain "$path:$line" "$included" "yaml-cpp belongs in a .cpp of pipeline/config"
  [[ $included != pybind11/* || $path == python/* ]] || complain "$path:$line" "$included" "what is bound knows nothing of Python"
  [[ ! $included =~ ^(spawn|sys/wait)\.h$ ]] || complain "$path:$line" "$included" "processes are started in Python"
done < <(includes)

while IFS=: read -r path line _; do  # a message about a shape gets its file from whoever knows it
  echo "$path:$line: throws InputError: stages know no files, and throw ShapeError"
  breaches=$((breaches + 1))
done < <(grep -rn --include='*.h' --include='*.cpp' 'throw InputError(' stages || true)

[[ $breaches -eq 0 ]]
