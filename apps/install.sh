#!/bin/bash
# Installs what building, running and plotting need, with apt, and only what is missing. Made for Debian 12.
# Usage: bash apps/install.sh. Exit status: 0 all there; 1 something is missing and cannot be installed, with the cause.
# SLOWSAND_SKIP_INSTALL=1 leaves it all to you, for instance on another system.
set -euo pipefail

packages=(
  g++ cmake ninja-build ccache binutils git ca-certificates # to build; the linker ld.gold is in binutils
  libdeal.ii-dev openmpi-bin libopenmpi-dev                 # boundary-value problems; brings Trilinos, p4est, HDF5
  libeigen3-dev librandom123-dev                            # grains
  libcli11-dev libfmt-dev nlohmann-json3-dev                # command line and summaries
  libgtest-dev libbenchmark-dev                             # tests
  python3 python3-numpy python3-h5py python3-matplotlib     # figures
  python3-pandas                                            # the recipes of docs/cookbook.md
)

fail()
{
  echo "install.sh: $*" >&2
  exit 1
}

list_missing()
{
  local package
  for package in "${packages[@]}"; do
    dpkg-query -W -f='${db:Status-Status}\n' "$package" 2>/dev/null | grep -qx installed || echo "$package"
  done
}

read_release()
{
  sed -n "s/^$2=\"\{0,1\}\([^\"]*\)\"\{0,1\}$/\1/p" "$1"
}

check_system()
{
  local id="" version="" name="this system"
  local release=${SLOWSAND_OS_RELEASE:-/etc/os-release} # named so that a test can stand in another system
  if [ -r "$release" ]; then
    id=$(read_release "$release" ID)
    version=$(read_release "$release" VERSION_ID)
    name=$(read_release "$release" PRETTY_NAME)
  fi
  if [ "$id" != debian ] || [ "$version" != 12 ]; then
    fail "Slowsand is built on Debian 12 (deal.II 9.4.1), this is $name; in a container: docker run -it debian:12." \
      "To go on with packages of your own, set SLOWSAND_SKIP_INSTALL=1."
  fi
  command -v apt-get >/dev/null || fail "apt-get is not there; missing packages: $*"
}

if [ "${SLOWSAND_SKIP_INSTALL:-0}" = 1 ]; then
  exit 0
fi
missing=()
if command -v dpkg-query >/dev/null; then
  read -r -a missing <<<"$(list_missing | tr '\n' ' ')" # no /dev/fd needed, as '< <(...)' would
  [ ${#missing[@]} -gt 0 ] || exit 0
else
  missing=("${packages[@]}")
fi
check_system "${missing[@]}"

as_root=()
if [ "$(id -u)" -ne 0 ]; then
  command -v sudo >/dev/null || fail "needs root or sudo to install: ${missing[*]}"
  as_root=(sudo)
fi
echo "install.sh: installing ${#missing[@]} packages and what they depend on: ${missing[*]}"
apt=("${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -qq -o DPkg::Lock::Timeout=300)
"${apt[@]}" update || fail "'apt-get update' failed, see above; is the network there?"
log=$(mktemp /tmp/slowsand-install.XXXXXX)
"${apt[@]}" install -y --no-install-recommends "${missing[@]}" >"$log" 2>&1 || {
  tail -n 20 "$log" >&2
  fail "'apt-get install' failed, see above and $log"
}
rm -f "$log"
