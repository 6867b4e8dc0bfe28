#!/usr/bin/env bash
# Installs what build and tests need on Debian 12 and later. Silent, and without network, where
# nothing is missing. Elsewhere it names the list and goes on: CMake says what it does not find.
set -euo pipefail

packages=(
  g++ cmake ninja-build ccache pkg-config git python3 clang-format
  libopenscenegraph-dev openscenegraph libgdal-dev gdal-bin libglm-dev libopenexr-dev
  libegl-dev libgl-dev libegl1 libgl1-mesa-dri libcli11-dev libpugixml-dev libembree-dev
  liberfa-dev libgtest-dev libnova-dev libproj-dev libbenchmark-dev xvfb gnuplot-nox blender-data
)

if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
  echo "install_deps: not a Debian system; needed here, by their Debian names: ${packages[*]}" >&2
  exit 0
fi

missing=()
for package in "${packages[@]}"; do
  status=$(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null) || status=absent
  [[ $status == installed ]] || missing+=("$package")
done
[[ ${#missing[@]} -gt 0 ]] || exit 0

as_root=()
if [[ $(id -u) -ne 0 ]]; then
  if ! command -v sudo >/dev/null; then
    echo "install_deps: FAILED: needs root or sudo to install: ${missing[*]}" >&2
    exit 1
  fi
  as_root=(sudo)
fi

apt() # the log is shown only where apt fails
{
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -o Acquire::Retries=3 "$@" \
    >"$log" 2>&1 </dev/null
}
log=$(mktemp)
trap 'rm -f "$log"' EXIT
echo "install_deps: installing ${missing[*]}"
if ! apt update || ! apt install --yes --no-install-recommends "${missing[@]}"; then
  tail -n 40 "$log" >&2
  echo "install_deps: FAILED to install: ${missing[*]}" >&2
  exit 1
fi
