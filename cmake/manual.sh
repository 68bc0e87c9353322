#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# What help2man reads, run by the build: the help of the program, with that of each subcommand as a section.
#   manual.sh PROGRAM --help | --version
set -euo pipefail
program=$1
[[ $2 == --help ]] || { "$program" "$2" | sed -n 1p; exit; }
help=$("$program" --help)
sed '/^Subcommands:/,$d; s/-h,--help /-h, --help/' <<< "$help"
echo '*Subcommands*'
for subcommand in $(sed -n '/^Subcommands:/,/^$/s/^  \([a-z]\+\) .*/\1/p' <<< "$help"); do
  # Its first two lines are its summary and its usage. The heading of a section ends with a colon.
  "$program" "$subcommand" --help | sed -n '1h
    2{s/.* \('"$subcommand"' .*\)/salbench \1:/p; x; s/^/  /p; s/.*//p}
    /^Examples:/,$d; /^  -h,/d; /^  /p'
  echo
done
# Those of the package are named; their options are of a program that may not be here.
sed -n '/^Subcommands of/,/^$/s/^  \([a-z]\+\) \+\(.*\)/salbench \1:\n  \2; its options: salbench \1 --help\n/p' <<< "$help"
# An empty line keeps one example from another.
sed -n '/^Examples:/,$p' <<< "$help" | sed 's/^  salbench .*/&\n/; s/^Exit status: /*Exit status*\n/'
