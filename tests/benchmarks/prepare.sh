# shellcheck shell=bash
# Sourced by engine.sh and scaling.sh: installs the peers, builds our program, makes the packing.
# Sets $here, $build (with --build DIR), $program, $work and $arguments, those that are left.
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
program=$build/tests/engine_benchmark
work=$build/tests/benchmarks

fail()
{
  echo "$(basename "$0"): $*" >&2
  exit 2
}

install_peers()
{
  local package missing=() as_root=()
  bash "$root/apps/install.sh" || exit 2 # what our own program needs, Google Benchmark too
  for package in lammps yade liggghts; do
    dpkg-query -W -f='${db:Status-Status}\n' "$package" 2>/dev/null | grep -qx installed || missing+=("$package")
  done
  [ ${#missing[@]} -gt 0 ] || return 0
  [ "$(id -u)" -eq 0 ] || as_root=(sudo)
  echo "installing ${missing[*]}"
  local apt=("${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -qq -o DPkg::Lock::Timeout=300)
  { "${apt[@]}" update && "${apt[@]}" install -y --no-install-recommends "${missing[@]}"; } >"$work/install.log" 2>&1 ||
    fail "cannot install ${missing[*]}, see $work/install.log"
}

build_program()
{
  if [ "$build" = "$root/build/release" ]; then
    bash "$root/apps/build.sh" engine_benchmark
  else
    { [ -f "$build/CMakeCache.txt" ] || cmake -S "$root" --preset release -B "$build"; } &&
      cmake --build "$build" --target engine_benchmark
  fi >"$work/build.log" 2>&1 || fail "engine_benchmark does not build, see $work/build.log"
}

# make_packing N FILE: cached, made anew when the file is not there.
make_packing()
{
  [ -s "$2" ] || { "$program" make "$2.part" --grains "$1" && mv "$2.part" "$2"; } || fail "no packing of $1 grains"
}

mkdir -p "$work"
install_peers
build_program
