#!/usr/bin/env bash
# Installs python3-stackmesh, and nothing else of ours, in a fresh Debian 12, meshes a file and an array there, then installs the program and compares bytes. Needs root.
#   try_in_clean_root.sh ROOT      a folder that does not exist, or a root that debootstrap has made
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
project=$(cd "$here/../.." && pwd)
root=$1
command -v debootstrap >/dev/null || { echo "try_in_clean_root.sh: error: debootstrap is missing" >&2; exit 1; }
if [[ ! -e $root/usr/bin/apt-get ]]; then
  debootstrap --variant=minbase bookworm "$root" http://deb.debian.org/debian >/dev/null
  cp /etc/resolv.conf "$root/etc/"
  chroot "$root" apt-get -q update
fi
mkdir -p "$root/stackmesh"
cp "$project"/build/packages/*.deb "$project/testdata/femur.nii.gz" "$here/try_installed.sh" "$root/stackmesh/"
mountpoint -q "$root/proc" || mount -t proc proc "$root/proc"
trap 'umount "$root/proc"' EXIT
install() { chroot "$root" env DEBIAN_FRONTEND=noninteractive apt-get -q -o Dpkg::Use-Pty=0 install -y --no-install-recommends "$@"; }
(cd "$root" && install ./stackmesh/$(cd "$root/stackmesh" && ls python3-stackmesh_*.deb))
chroot "$root" bash /stackmesh/try_installed.sh /stackmesh
install ./stackmesh/$(cd "$root/stackmesh" && ls stackmesh_*.deb)
chroot "$root" bash /stackmesh/try_installed.sh /stackmesh
