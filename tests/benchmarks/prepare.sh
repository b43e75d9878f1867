# shellcheck shell=bash
# Sourced by engine.sh, scaling.sh and coupled.sh: installs the peers (packages in the array peers, else the DEM codes),
# builds our program, makes the packing. Sets $program beside what programs.sh sets.
# shellcheck source=tests/benchmarks/programs.sh
. "$(dirname "${BASH_SOURCE[0]}")/programs.sh"
program=$build/tests/engine_benchmark
[ -n "${peers+set}" ] || peers=(lammps yade liggghts)

install_peers()
{
  local package missing=() as_root=()
  for package in "${peers[@]}"; do
    dpkg-query -W -f='${db:Status-Status}\n' "$package" 2>/dev/null | grep -qx installed || missing+=("$package")
  done
  [ ${#missing[@]} -gt 0 ] || return 0
  [ "$(id -u)" -eq 0 ] || as_root=(sudo)
  echo "installing ${missing[*]}"
  local apt=("${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -qq -o DPkg::Lock::Timeout=300)
  { "${apt[@]}" update && "${apt[@]}" install -y --no-install-recommends "${missing[@]}"; } >"$work/install.log" 2>&1 ||
    fail "cannot install ${missing[*]}, see $work/install.log"
}

# make_packing N FILE: cached, made anew when the file is not there.
make_packing()
{
  [ -s "$2" ] || { "$program" make "$2.part" --grains "$1" && mv "$2.part" "$2"; } || fail "no packing of $1 grains"
}

build_programs engine_benchmark
install_peers
