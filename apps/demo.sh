#!/bin/bash
# A sand specimen creeps: installs what is missing, builds, runs the default oedometer, draws its figures.
# Output: runs/oedometer_creep, or runs/oedometer_creep_2 and so on when there is such a run already.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
started=$SECONDS
case_file=apps/cases/bvp_oedometer_creep.prm
points=8 # Gauss points of this case: more processes than that would idle

step()
{
  echo "== $* ($((SECONDS - started)) s)"
}

choose_run_folder()
{
  local folder=runs/oedometer_creep number=1
  while [ -e "$folder" ]; do
    number=$((number + 1))
    folder=runs/oedometer_creep_$number
  done
  echo "$folder"
}

trap 'echo "demo.sh: stopped in line $LINENO, see the message above" >&2' ERR
step "packages"
bash apps/install.sh
step "build"
bash apps/build.sh slowsand-bvp slowsand-rev slowsand-replay

cores=$(env -u OMP_NUM_THREADS nproc)
ranks=$((cores < points ? cores : points))
run=$(choose_run_folder)
mkdir -p runs
# In a container people are root, and cores may be fewer than Open MPI's slots; one thread a process is what pays.
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
export OMPI_MCA_rmaps_base_oversubscribe=1 OMPI_MCA_hwloc_base_binding_policy=none
export OPENBLAS_NUM_THREADS=1 OMP_NUM_THREADS=1 DEAL_II_NUM_THREADS=1
step "run on $ranks processes, into $run"
mpirun -n "$ranks" build/release/slowsand-bvp "$case_file" --output "$run"
step "figures"
/usr/bin/python3 apps/slowsand-plot "$run" --figures creep,compression,grading,stress_path,specimen,rev
step "done; history in $run/history.csv, mesh and fields in $run/fields.pvd (ParaView)"
