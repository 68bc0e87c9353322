#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# licences.sh ROOT: every source file names its licence in its first three lines. Names each that does not.
set -euo pipefail
cd "$1"
folders=()
for folder in .ci cache cmake docs io models pipeline python scripts stages tests; do
  [[ ! -d $folder ]] || folders+=("$folder")
done

# Files with a known ending, and programs, whatever their name.
sources() {
  find "${folders[@]}" CMakeLists.txt -type f -not -path 'tests/fuzz/corpus/*' -not -path '*/golden/*' -not -path '*/__pycache__/*' \
    \( -name '*.h' -o -name '*.cpp' -o -name '*.py' -o -name '*.sh' -o -name '*.cmake' -o -name '*.js' -o -name '*.css' -o \
    -name CMakeLists.txt -o -perm -u=x -not -name '*.*' \) -print0
}

missing=0
while IFS= read -r -d '' file; do
  head -n 3 "$file" | grep -q 'SPDX-License-Identifier: GPL-3.0-or-later' && continue
  echo "$file: no line 'SPDX-License-Identifier: GPL-3.0-or-later' at its top"
  missing=$((missing + 1))
done < <(sources)
[[ $missing -eq 0 ]]
