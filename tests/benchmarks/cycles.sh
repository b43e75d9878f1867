#!/bin/bash
# Cycles to equilibrium of the shipped oedometer creep and what they do to its creep strain, for several ways to rest:
# bash tests/benchmarks/cycles.sh [--seeds N] [--grains N] [--only VARIATION...] [--set "Section/Name=value"]...
# [--build DIR]. With --paper-rule: the time-to-fracture paper's 150000 cycles against the criterion, on one smaller
# case with the same masses; minutes on one core. Cycles are counted, nothing is timed. The last output is CSV.
set -euo pipefail
# shellcheck source=tests/benchmarks/programs.sh
. "$(dirname "${BASH_SOURCE[0]}")/programs.sh"

build_programs slowsand-rev
mkdir -p "$work/cycles"
exec /usr/bin/python3 "$here/cycles.py" "$root/apps/cases/rev_oedometer_creep.prm" --program "$build/slowsand-rev" \
  --work "$work/cycles" "${arguments[@]}"
