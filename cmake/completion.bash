# SPDX-License-Identifier: GPL-3.0-or-later
# shellcheck shell=bash
# bash completion for salbench, whose words it takes from the help texts.
_salbench() {
  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]} subcommand=() help words configs='' folder
  COMPREPLY=()
  ((COMP_CWORD == 1)) || subcommand=("${COMP_WORDS[1]}")
  help=$("${COMP_WORDS[0]}" "${subcommand[@]}" --help 2> /dev/null)
  if ((COMP_CWORD == 1)) || [[ $word == -* ]]; then
    words=$(sed -n '/^Examples:/q; s/^  -[a-z]\( [A-Z]*\)\?, /  /; s/^  \(-*[a-z][a-z-]*\)\( .*\|$\)/\1/p' <<< "$help")
    mapfile -t COMPREPLY < <(compgen -W "$words" -- "$word")
    return
  fi
  # The value of an option, as in "  --out DIR": what is left empty here is completed as a file.
  [[ $help != *$'\n'"  $before "[A-Z]* ]] || return
  folder=$(dirname "$(command -v "${COMP_WORDS[0]}")")/../share/salbench/configs
  [[ ! -d $folder ]] || configs=$(cd "$folder" && printf '%s ' *.yaml)
  mapfile -t COMPREPLY < <(compgen -W "${configs//.yaml/}" -- "$word"; compgen -f -- "$word")
  compopt -o filenames 2> /dev/null
}
complete -o bashdefault -o default -F _salbench salbench
