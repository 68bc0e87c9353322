#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# installation.sh BUILD: what `cmake --install` puts into an empty folder works there, and says what the program says.
set -euo pipefail
source=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
prefix=$(mktemp -d)
trap 'rm -rf "$prefix"' EXIT
complain() { echo "$*"; exit 1; }

cmake --install "$1" --prefix "$prefix" > /dev/null
cd /
salbench=$prefix/bin/salbench package=$prefix/lib/python3/dist-packages
export PYTHONPATH=$package PYTHONDONTWRITEBYTECODE=1
version=$("$salbench" --version | sed -n "1s/^salbench //p")
for file in share/doc/salbench/{README.md,CHANGELOG.md,CITATION.cff,LICENSE,docs/data_dictionary.md,docs/index.md} share/man/man1/salbench{,-engine}.1; do
  [[ -s $prefix/$file ]] || complain "$file: not installed"
done

# One version everywhere, with one date.
date=$(sed -n "s/^## \[$version\] - //p" "$source/CHANGELOG.md")
grep -qx "version: $version" "$source/CITATION.cff" || complain "CITATION.cff: version is not $version"
grep -qx "date-released: \"$date\"" "$source/CITATION.cff" || complain "CITATION.cff: date is not that of CHANGELOG.md"
month=$(LC_ALL=C date -u -d "$date" '+%B %Y')
grep -q "^.TH SALBENCH \"1\" \"$month\" \"salbench $version\"" "$prefix/share/man/man1/salbench.1" ||
  complain "salbench.1: not of $version, $month"

# Configurations by name, and a file of that name first.
[[ $("$salbench" config shrec07_text) == *$'\nprotocol: text'* ]] || complain "shrec07_text: not found by its name"
(cd "$prefix" && echo 'protocol: published' > shrec07_text &&
  [[ $("$salbench" config shrec07_text) == *$'\nprotocol: published'* ]]) || complain "shrec07_text: the file comes first"
"$salbench" config shrec08 2> /dev/null && complain "shrec08: there is no such configuration"

# The Python package: of this version, and with its types. The native program finds in its cache what it would compute.
[[ $(/usr/bin/python3 -c 'import salbench; print(salbench.__version__)') == "$version" ]] || complain "import salbench: not of $version"
for file in py.typed configs/paper/aims.csv configs/published/tasse2016.csv report/templates/index.html pages/static/report.css; do
  [[ -e $package/salbench/$file ]] || complain "salbench/$file: not installed"
done
"$source/scripts/toy_meshes.py" "$prefix/meshes" 2 12 8
echo '{dataset: {layout: folder, participants: simulated, scans: false}, models: {RS: }}' > "$prefix/toy.yaml"
(cd "$prefix" && /usr/bin/python3 - << 'END') || complain "Results.report(): fails"
import salbench
print(salbench.run("toy.yaml", data="meshes", cache="cache", out="out", progress=False).report("report"))
END
grep -q 'Simulated participants' "$prefix/report/index.html" || complain "Results.report(): wrote no report"
(cd "$prefix" && bin/salbench-engine toy.yaml meshes cache engine > /dev/null && cmp {out,engine}/results.csv &&
  grep -qx 'artefacts_computed: 0' engine/run.yaml) || complain "salbench-engine: has other scores, or computes them anew"

# The manual page and the completion have every subcommand and option of the help.
page=$(sed 's/\\-/-/g' "$prefix/share/man/man1/salbench.1")
source "$prefix/share/bash-completion/completions/salbench"
completed() { # WORD...: what the shell would offer for the last one
  COMP_WORDS=("$salbench" "$@") COMP_CWORD=$#
  _salbench || true
  echo " ${COMPREPLY[*]} "
}
subcommands=$("$salbench" --help | sed -n '/^Subcommands:/,/^$/s/^  \([a-z]\+\) .*/\1/p')
[[ $(wc -w <<< "$subcommands") -eq 13 ]] || complain "--help: subcommands not recognised"
first=$(completed '')
for subcommand in $subcommands; do
  options=$(completed "$subcommand" -)
  [[ $page == *$'\n.SS "salbench '"$subcommand "* ]] || complain "salbench.1: no $subcommand"
  [[ $first == *" $subcommand "* ]] || complain "completion: no $subcommand"
  for option in $("$salbench" "$subcommand" --help | sed -n 's/^  \(-c CONFIG, \)\?\(--[a-z-]\+\).*/\2/p'); do
    [[ $page == *"\\fB$option\\fR"* ]] || complain "salbench.1: no $option"
    [[ $options == *" $option "* ]] || complain "completion: no $subcommand $option"
  done
done
[[ $(completed run shrec07_t) == ' shrec07_text ' ]] || complain "completion: no installed configuration"
[[ $(completed run shrec07_text --out shrec) == '  ' ]] || complain "completion: a configuration in place of a folder"

command -v groff > /dev/null || exit 0
warnings=$(groff -man -Kutf8 -Tutf8 -ww -z "$prefix/share/man/man1/salbench.1" 2>&1)
[[ -z $warnings ]] || complain "salbench.1: $warnings"
