#!/bin/bash
# What single precision does to stress, equilibrium, creep and energy: bash tests/benchmarks/single_precision.sh
# [PACKING] [--protocol-cycles N] [--rest-cycles N] [--energy-cycles N] [--creep-duration SECONDS]. PACKING is a text
# file of smooth grains at 9.6 MPa; without it, 1000 grains are made and kept in the build folder. The output is CSV.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
root=$(cd "$here/../.." && pwd)
build=$root/build/release
packing=$build/tests/benchmarks/grains-1000.txt
mkdir -p "$(dirname "$packing")"
bash "$root/apps/build.sh" engine_benchmark single_precision >"$build/tests/benchmarks/build.log" 2>&1 ||
  { echo "single_precision.sh: does not build, see $build/tests/benchmarks/build.log" >&2 && exit 2; }
if [ $# -gt 0 ] && [ "${1#-}" = "$1" ]; then
  packing=$1
  shift
elif [ ! -s "$packing" ]; then
  "$build/tests/engine_benchmark" make "$packing.part" --grains 1000 && mv "$packing.part" "$packing"
fi
exec "$build/tests/single_precision" "$packing" "$@"
