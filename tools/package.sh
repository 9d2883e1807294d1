#!/usr/bin/env bash
# Builds the Debian packages; looks them over with lintian, where it is installed.
#   tools/package.sh [--bare] [FOLDER]    where they go; out/packages if not given
# --bare (root, debootstrap): also installs them into a bare Debian 12, and runs mvtp, examples in Python, and a program
# that uses the library there; takes them away; and has pip build and install the package from the source.
set -euo pipefail
bare=false
[ "${1:-}" = --bare ] && { bare=true; shift; }
folder=$(realpath -m "${1:-"$(dirname "$0")/../out/packages"}")
cd "$(dirname "$0")/.."
if $bare && ! { [ "$(id -u)" -eq 0 ] && command -v debootstrap >/dev/null; }; then
  echo "package.sh: --bare needs root and debootstrap" >&2
  exit 2
fi

tools/install_packages.sh dpkg-dev file
cmake --preset release >/dev/null
cmake --build --preset release --target mvtp_manual_pages mvtp_python  # all that is installed
rm -f "$folder"/{mvtp,libmvtp-dev,python3-mvtp}_*.deb  # it may hold other things
cpack --config build/release/CPackConfig.cmake -B "$folder" >/dev/null
rm -rf "$folder/_CPack_Packages"
if command -v lintian >/dev/null; then
  lintian --fail-on warning --allow-root "$folder"/*.deb
fi
ls -l "$folder"/*.deb

$bare || exit 0
root=$(mktemp -d)
trap 'rm -rf "$root"' EXIT
chmod 755 "$root"
debootstrap --variant=minbase bookworm "$root" >/dev/null
echo force-unsafe-io >"$root/etc/dpkg/dpkg.cfg.d/unsafe-io"  # it is thrown away: no fsync
cp "$folder"/*.deb "$root"
mkdir "$root/opt/source"
git ls-files -z | xargs -0 cp --parents -t "$root/opt/source"
unshare --mount --pid --fork --mount-proc="$root/proc" chroot "$root" bash -euxc '
  export DEBIAN_FRONTEND=noninteractive LC_ALL=C.UTF-8
  mkdir -p /dev/pts
  mount -t devpts devpts /dev/pts  # apt writes its log through a terminal
  apt-get update -qq
  apt-get install -y -qq --no-install-recommends ./mvtp_*.deb >/dev/null
  mvtp --version
  mvtp coordinate -c opt/source/scenarios/crossroads/crossroads.sumocfg --output-dir run --quiet
  test -s run/summary.json
  test -s run/view.html
  mvtp solve -i opt/source/scenarios/circle/circle8.yaml -o plan.yaml
  mvtp validate -i opt/source/scenarios/circle/circle8.yaml -s plan.yaml
  apt-get install -y -qq --no-install-recommends ./python3-mvtp_*.deb >/dev/null
  python3 opt/source/docs/examples/python/solve.py
  python3 opt/source/docs/examples/python/controller.py --end 60
  apt-get install -y -qq --no-install-recommends ./libmvtp-dev_*.deb g++ cmake make >/dev/null
  cmake -S opt/source/docs/examples -B examples >/dev/null
  cmake --build examples >/dev/null
  examples/solve
  examples/controller

  apt-get purge -y -qq mvtp python3-mvtp libmvtp-dev >/dev/null
  left=$(find / -xdev -name "*mvtp*" -not -path "/opt/*" -not -path "/var/cache/*" -not -name "*.deb")
  test -z "$left"

  cd /opt/source
  tools/install_packages.sh python3-venv
  /usr/bin/python3 -m venv --system-site-packages /venv
  /venv/bin/pip install --quiet --no-index .  # no index: nothing from the network
  cd /
  /venv/bin/python opt/source/docs/examples/python/solve.py
  /venv/bin/python opt/source/docs/examples/python/controller.py --end 60
  /venv/bin/mvtp --version' 2>&1
