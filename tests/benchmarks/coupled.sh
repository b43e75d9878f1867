#!/bin/bash
# Compares Slowsand with YADE and Escript on one boundary-value problem of two scales, a specimen between rough ends with 64
# REVs of 500 grains: bash tests/benchmarks/coupled.sh [--steps N] [--runs N] [--pressure PA] [--tolerance SHARE]
# [--only SYSTEM...] [--build DIR]. Processor time is what counts, so other work on the machine disturbs little.
# Exit status: 0 ours meets the bounds in coupled.py, 1 it does not, 2 something is missing. The last output is CSV.
set -euo pipefail
peers=(yade python3-escript)
# shellcheck source=tests/benchmarks/prepare.sh
. "$(dirname "${BASH_SOURCE[0]}")/prepare.sh"

build_programs slowsand-bvp
packing=$work/grains-500.txt
make_packing 500 "$packing"
exec /usr/bin/python3 "$here/coupled.py" "$root/apps/cases/bvp_triaxial_specimen.prm" "$packing" \
  --program "$build/slowsand-bvp" --work "$work" "${arguments[@]}"
