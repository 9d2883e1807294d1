#!/usr/bin/env bash
# Installs what the project needs from Debian's or Ubuntu's packages, and the packages named as
# arguments; does nothing if all is there.
set -euo pipefail

packages=(
  g++ cmake ninja-build ccache
  libeigen3-dev libfcl-dev libompl-dev libboost-serialization-dev
  libboost-filesystem-dev libboost-system-dev libtinyxml2-dev libyaml-cpp-dev nlohmann-json3-dev
  libcli11-dev libfmt-dev zlib1g-dev libtbb-dev
  libgtest-dev libgmock-dev libbenchmark-dev
  python3-matplotlib
  pybind11-dev python3-dev python3-numpy python3-pytest
  libsystemd-dev dbus-daemon
  sumo sumo-tools
  zsh fish libxml2-utils mkdocs-material doxygen parallel
  chromium-headless-shell librsvg2-bin
  "$@"
)

missing=()
for package in "${packages[@]}"; do
  dpkg-query --show --showformat='${db:Status-Status}' "$package" 2>/dev/null |
    grep -qx installed || missing+=("$package")
done
[ ${#missing[@]} -gt 0 ] || exit 0

as_root=()
if [ "$(id -u)" -ne 0 ]; then
  command -v sudo >/dev/null || {
    echo "install_packages.sh: missing: ${missing[*]}; install them as root, or install sudo" >&2
    exit 2
  }
  as_root=(sudo)
fi
echo "Installing ${#missing[@]} packages: ${missing[*]}" >&2
"${as_root[@]}" apt-get update -qq
"${as_root[@]}" env DEBIAN_FRONTEND=noninteractive \
  apt-get install -y -qq --no-install-recommends "${missing[@]}" >/dev/null
