#!/bin/bash
# Runs the four creep laws, the time scales and the parameters of docs/alternatives.md on small REVs and draws them: some
# minutes on two cores. What has finished is kept in runs/alternatives. Usage: bash docs/alternatives/run.sh [DIR of programs]
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
programs=${1:-build/release}
for study in apps/cases/study_creep_laws.json docs/alternatives/study_time_scale.json docs/alternatives/study_parameters.json; do
  folder=runs/alternatives/$(basename "$study" .json)
  if [ -d "$folder" ]; then
    apps/slowsand-study "$study" --resume "$folder" --programs "$programs"
  else
    apps/slowsand-study "$study" --output "$folder" --programs "$programs"
  fi
done
exec /usr/bin/python3 docs/alternatives/draw.py runs/alternatives docs/alternatives
