#!/bin/bash
# Regenerates tables and figures of the verification report from the built programs (bash apps/build.sh), some twenty
# minutes on two cores. Usage: bash docs/verification/run.sh [--quick] [--programs DIR] [--only STUDY...]; --help says more.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
exec /usr/bin/python3 tests/verification/study/report.py "$@"
