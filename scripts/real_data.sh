# SPDX-License-Identifier: GPL-3.0-or-later
# shellcheck shell=bash
# Sourced by scripts/test, scripts/check and scripts/releases in the root of the checkout: where no SALBENCH_DATA names a folder with
# SchellingData/ and reference/, it becomes the one beside the checkout, if there is one.
if [[ -z ${SALBENCH_DATA:-} && -f ../shared/data/unpack ]]; then
  SALBENCH_DATA=$(bash ../shared/data/unpack)
  export SALBENCH_DATA
fi
