#!/bin/bash
# The experiments of the time-to-fracture paper from the built programs (bash apps/build.sh).
# Usage: bash apps/cases/paper/run.sh small|full [fig1 fig6 triaxial ...] [--programs DIR] [--output DIR] [--seeds N]
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../../.." && pwd)
exec /usr/bin/python3 "$root/apps/paper/reproduce.py" "$@"
