#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# What help2man reads, run by the build: the help of the program, with that of each subcommand as a section.
#   manual.sh PROGRAM --help | --version
set -euo pipefail
export COLUMNS=1000  # no line of help is broken
program=$1
[[ $2 == --help ]] || { "$program" "$2" | sed -n 1p; exit; }
help=$("$program" --help)
sed '/^Subcommands:/,$d' <<< "$help"
echo '*Subcommands*'
for subcommand in $(sed -n '/^Subcommands:/,/^$/s/^  \([a-z]\+\) .*/\1/p' <<< "$help"); do
  # Its first line is its summary, which its usage precedes here. The heading of a section ends with a colon.
  "$program" "$subcommand" --help | sed -n '1{h; d}
    /^Usage: /{s/^Usage: \(.*\)/\1:/p; x; s/.*/  &\n/p; d}
    /^Examples:/,$d; /^  -h,/d; /^  /p'
  echo
done
# An empty line keeps one example from another.
sed -n '/^Examples:/,$p' <<< "$help" | sed 's/^  salbench .*/&\n/; s/^Exit status: /*Exit status*\n/'
