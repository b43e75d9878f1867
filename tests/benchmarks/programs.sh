# shellcheck shell=bash
# Sourced by the scripts beside it: where things are, and our own programs built.
# Sets $here, $root, $build (with --build DIR), $work and $arguments, those that are left.
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
work=$build/tests/benchmarks

fail()
{
  echo "$(basename "$0"): $*" >&2
  exit 2
}

# build_programs TARGET...: with what they need from Debian.
build_programs()
{
  bash "$root/apps/install.sh" || exit 2
  if [ "$build" = "$root/build/release" ]; then
    bash "$root/apps/build.sh" "$@"
  else
    { [ -f "$build/CMakeCache.txt" ] || cmake -S "$root" --preset release -B "$build"; } &&
      cmake --build "$build" --target "$@"
  fi >"$work/build.log" 2>&1 || fail "$* does not build, see $work/build.log"
}

mkdir -p "$work"
