#!/bin/bash
# Installs what is missing, builds everything, runs every test. Exit status and last lines are those of ctest.
# Usage: bash tests/run.sh [options of ctest, such as -R plot]
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
bash apps/install.sh
bash apps/build.sh
exec ctest --preset release --no-tests=error --parallel "$(env -u OMP_NUM_THREADS nproc)" "$@"
