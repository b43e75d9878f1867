#!/bin/bash
# Cycles to equilibrium of the shipped oedometer creep and what they do to its creep strain, for several ways to rest:
# bash tests/benchmarks/cycles.sh [--seeds N] [--grains N] [--only VARIATION...] [--set "Section/Name=value"]...
# [--build DIR]. With --paper-rule: the time-to-fracture paper's 150000 cycles against the criterion, on one smaller
# case with the same masses; minutes on one core. Cycles are counted, nothing is timed. The last output is CSV.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
root=$(cd "$here/../.." && pwd)
build=$root/build/release
arguments=()
while [ $# -gt 0 ]; do
  case $1 in
    --build) build=$(realpath -m "$2") && shift 2 ;;
    *) arguments+=("$1") && shift ;;
  esac
done
program=$build/slowsand-rev
work=$build/tests/benchmarks/cycles
mkdir -p "$work"

fail()
{
  echo "cycles.sh: $*" >&2
  exit 2
}

if [ "$build" = "$root/build/release" ]; then
  bash "$root/apps/install.sh" || exit 2
  bash "$root/apps/build.sh" slowsand-rev >"$work/build.log" 2>&1 ||
    fail "slowsand-rev does not build, see $work/build.log"
elif [ ! -x "$program" ]; then
  fail "no slowsand-rev in $build"
fi
exec /usr/bin/python3 "$here/cycles.py" "$root/apps/cases/rev_oedometer_creep.prm" --program "$program" --work "$work" \
  "${arguments[@]}"
