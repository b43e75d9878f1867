#!/bin/bash
# What single precision does to stress, equilibrium, creep and energy: bash tests/benchmarks/single_precision.sh
# [PACKING] [--build DIR] [--protocol-cycles N] [--rest-cycles N] [--energy-cycles N] [--creep-duration SECONDS]. PACKING is a text
# file of smooth grains at 9.6 MPa; without it, 1000 grains are made and kept in the build folder. The output is CSV.
set -euo pipefail
# shellcheck source=tests/benchmarks/programs.sh
. "$(dirname "${BASH_SOURCE[0]}")/programs.sh"

build_programs engine_benchmark single_precision
packing=$work/grains-1000.txt
if [ ${#arguments[@]} -gt 0 ] && [ "${arguments[0]#-}" = "${arguments[0]}" ]; then
  packing=${arguments[0]}
  arguments=("${arguments[@]:1}")
elif [ ! -s "$packing" ]; then
  "$build/tests/engine_benchmark" make "$packing.part" --grains 1000 && mv "$packing.part" "$packing"
fi
exec "$build/tests/single_precision" "$packing" "${arguments[@]}"
