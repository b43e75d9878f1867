#!/bin/bash
# Runs the piles of docs/pile.md and draws them: installed, wished in place and withdrawn, three seeds each, then other first radii,
# meshes, REV sizes, stresses and steps. About an hour and a half on one undisturbed core; what has finished is kept in runs/pile, and
# a run that was cut goes on. Usage: bash docs/pile/run.sh [--programs DIR] [--output DIR] [--only NAME...] [--draw]; --help says more.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
exec /usr/bin/python3 docs/pile/study.py "$@"
