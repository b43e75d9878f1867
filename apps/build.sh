#!/bin/bash
# Configures and builds the release preset. Usage: bash apps/build.sh [TARGET...]; without a target, all of them.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

# A file that includes deal.II takes up to 2.2 GB to compile: as many jobs as cores, but no more than fit into memory.
count_jobs()
{
  local cores available_gib
  cores=$(env -u OMP_NUM_THREADS nproc)
  available_gib=$(awk '/^MemAvailable:/ { print int($2 / 1048576) }' /proc/meminfo)
  local jobs=$((available_gib / 2 < cores ? available_gib / 2 : cores))
  echo $((jobs > 1 ? jobs : 1))
}

launcher=()
if command -v ccache >/dev/null; then
  launcher=(-DCMAKE_CXX_COMPILER_LAUNCHER=ccache -DCMAKE_C_COMPILER_LAUNCHER=ccache)
fi
log=$(mktemp /tmp/slowsand-configure.XXXXXX)
cmake --preset release "${launcher[@]}" >"$log" 2>&1 || {
  cat "$log" >&2
  echo "build.sh: configuring failed, see above" >&2
  exit 1
}
rm -f "$log"
cmake --build --preset release --parallel "$(count_jobs)" ${1:+--target "$@"}
