#!/bin/bash
# Regenerates docs/parameters.md from the programs' own templates.
# Usage: bash docs/parameters.sh [DIR of the programs: build/release]
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
exec /usr/bin/python3 tests/tools/check_parameters.py --source . --build "${1:-build/release}" --write
