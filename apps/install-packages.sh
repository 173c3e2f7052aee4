#!/usr/bin/env bash
# Installs the Debian packages that stackmesh needs; the one place where they are listed.
#   install-packages.sh [--tests] [--pictures]
# Without options: what builds the program. --tests adds what the tests need, --pictures what apps/render.py needs.
set -euo pipefail

program=(
  g++ cmake ninja-build ccache
  libopencv-dev # the small -dev packages of its parts lack OpenCVConfig.cmake
  libcgal-dev libtet1.5-dev libopenmesh-dev
  libinsighttoolkit5-dev libdcmtk-dev libnifti2-dev libpng-dev libtiff-dev
  libexodusii-dev libmedc-dev # .exo and .med; Debian builds both upon Open MPI, which comes along and is not used
  libssl-dev # libcrypto, for digests
  libtbb-dev libcli11-dev nlohmann-json3-dev libpugixml-dev
  libjs-three libjs-chart.js # inside the HTML report
  python3-dev python3-pybind11 pybind11-dev python3-numpy # the Python module
)
tests=(
  libgtest-dev libbenchmark-dev
  clang-format # compares the source with .clang-format
  doxygen texlive-binaries # the reference of the public headers; bibtex for its bibliography
  python3 python3-numpy python3-scipy python3-nibabel python3-pydicom python3-pil python3-vtk9 python3-meshio python3-h5py python3-jsonschema gmsh calculix-ccx
  chromium chromium-driver python3-selenium # opens the HTML report
  slurmctld slurmd slurm-client munge snakemake # engines that cohorts are run by
)
pictures=(python3-vtk9 xvfb xauth libgl1-mesa-dri)

fail() {
  echo "install-packages.sh: error: $*" >&2
  exit 1
}

wanted=("${program[@]}")
for argument in "$@"; do
  case $argument in
    --tests) wanted+=("${tests[@]}") ;;
    --pictures) wanted+=("${pictures[@]}") ;;
    -h | --help)
      sed -n '2,4s/^# //p' "$0"
      exit 0
      ;;
    *) fail "unknown option '$argument'; known are --tests and --pictures" ;;
  esac
done

if ! command -v apt-get >/dev/null || ! command -v dpkg-query >/dev/null; then
  fail "this needs Debian 12 or a relative of it (apt-get is missing); install the counterparts of: ${wanted[*]}"
fi

missing=()
for package in "${wanted[@]}"; do
  if [[ $(dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null || true) != installed ]]; then
    missing+=("$package")
  fi
done
if [[ ${#missing[@]} -eq 0 ]]; then
  echo "packages: all ${#wanted[@]} are installed"
  exit 0
fi

as_root=()
if [[ $(id -u) -ne 0 ]]; then
  command -v sudo >/dev/null || fail "installing packages needs root; run it as root or install sudo"
  as_root=(sudo)
fi
apt() { "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -q "$@"; }

echo "packages: installing ${missing[*]}"
start=$SECONDS
for try in 1 2 3 4; do
  # Any error, so that one unreachable source does not pass as success.
  if apt -o APT::Update::Error-Mode=any update; then break; fi
  [[ $try -lt 4 ]] || fail "apt-get update failed $try times; check the network and the apt sources"
  echo "packages: apt-get update failed, trying again in $((5 * try)) s" >&2
  sleep $((5 * try))
done
apt -o Dpkg::Use-Pty=0 -o Acquire::Retries=3 -o DPkg::Lock::Timeout=300 install -y --no-install-recommends "${missing[@]}" ||
  fail "apt-get could not install: ${missing[*]}"
echo "packages: done in $((SECONDS - start)) s"
