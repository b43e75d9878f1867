#!/bin/bash
# Cost of a grain and step, ours and LAMMPS's, from 1000 to 200000 grains, and ours after a fifth of the grains has
# split: bash tests/benchmarks/scaling.sh [--runs N] [--clock wall|cpu] [--build DIR]. The last output is CSV.
# The larger packings are the one of 11497 grains several times side by side; all are kept in the build folder.
set -euo pipefail
# shellcheck source=tests/benchmarks/prepare.sh
. "$(dirname "${BASH_SOURCE[0]}")/prepare.sh"

make_packing 1000 "$work/grains-1000.txt"
make_packing 11497 "$work/grains-11497.txt"
exec /usr/bin/python3 "$here/scaling.py" "$work/grains-1000.txt" "$work/grains-11497.txt" --benchmark "$program" \
  --work "$work" "${arguments[@]}"
