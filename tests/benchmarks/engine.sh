#!/bin/bash
# Compares Slowsand with LAMMPS, LIGGGHTS and YADE on one packing: bash tests/benchmarks/engine.sh [PACKING] [--runs N]
# [--steps N] [--clock wall|cpu] [--only SYSTEM...] [--build DIR]. PACKING is a text file as dem/packing_file.h says;
# without it, 11497 grains at 9.6 MPa are made and kept in the build folder.
# Exit status: 0 all stresses agree, 1 they do not, 2 something is missing. The last output is CSV.
set -euo pipefail
# shellcheck source=tests/benchmarks/prepare.sh
. "$(dirname "${BASH_SOURCE[0]}")/prepare.sh"

packing=$work/grains-11497.txt
if [ ${#arguments[@]} -gt 0 ] && [ "${arguments[0]#-}" = "${arguments[0]}" ]; then
  packing=${arguments[0]}
  arguments=("${arguments[@]:1}")
else
  make_packing 11497 "$packing"
  # Near rest the codes agree within 0.1 %; twice the tangential stiffness in one of them is worth 2.6 % after 1000 steps.
  arguments=(--tolerance 0.01 "${arguments[@]}")
fi
exec /usr/bin/python3 "$here/engine.py" "$packing" --benchmark "$program" --work "$work" "${arguments[@]}"
