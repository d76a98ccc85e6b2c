#!/bin/sh
# Installs what is missing, nothing when all is there:
#   Debian packages    compiler, CMake and libraries
#   .venv              a Python environment with the packages of the groups named
#
#   sh tools/setup.sh [GROUP...]      groups: post test lint mesh (files in tools/requirements:
#                                     GROUP.txt for Python, GROUP.debian for Debian)
set -eu

root=$(CDPATH='' cd -- "$(dirname -- "$0")/.." && pwd)
packages="ca-certificates cmake gcc gfortran libc6-dev libhdf5-dev libmetis-dev
  libmumps-seq-dev libopenblas-dev libsuitesparse-dev make python3 python3-venv zlib1g-dev"

say() {
  printf '%s\n' "setup: $*" >&2
}

is_installed() {
  [ "$(dpkg-query -W -f='${db:Status-Status}' "$1" 2>/dev/null)" = installed ]
}

as_root() {
  if [ "$(id -u)" -eq 0 ]; then
    "$@"
  else
    sudo "$@"
  fi
}

add_debian_packages() {
  for group in "$@"; do
    list="$root/tools/requirements/$group.debian"
    [ ! -f "$list" ] || packages="$packages $(cat "$list")"
  done
}

install_debian_packages() {
  if ! command -v dpkg-query >/dev/null 2>&1; then
    say "this is no Debian; these packages of Debian 12, or their equals, must be there:" $packages
    return
  fi
  missing=""
  case $(dpkg --print-architecture) in
    amd64 | arm64) packages="$packages libisal-dev" ;; # not there for others, and not needed
  esac
  for package in $packages; do
    is_installed "$package" || missing="$missing $package"
  done
  [ -n "$missing" ] || return 0

  say "installing the Debian packages:$missing"
  if [ "$(id -u)" -ne 0 ] && ! command -v sudo >/dev/null 2>&1; then
    say "this needs root or sudo. Ask your administrator to run:"
    say "  apt-get install --no-install-recommends$missing"
    exit 1
  fi
  as_root apt-get update -q >&2 || say "apt-get update failed; trying with the lists that are there"
  if ! as_root env DEBIAN_FRONTEND=noninteractive \
    apt-get install -q -y --no-install-recommends $missing >&2; then
    say "apt-get could not install:$missing"
    exit 1
  fi
}

# The stamp of a group holds the checksum of all requirements: a second run skips the group.
install_python_packages() {
  venv="$root/.venv"
  if ! "$venv/bin/python" -c "" 2>/dev/null; then
    say "making the Python environment .venv"
    rm -rf "$venv"
    /usr/bin/python3 -m venv "$venv"
  fi
  checksum=$(cat "$root"/tools/requirements/*.txt "$root/post/pyproject.toml" | sha256sum)
  for group in "$@"; do
    requirements="$root/tools/requirements/$group.txt"
    stamp="$venv/installed-$group"
    if [ ! -f "$requirements" ]; then
      say "there is no group '$group' in tools/requirements"
      exit 1
    fi
    if [ -f "$stamp" ] && [ "$(cat "$stamp")" = "$checksum" ]; then
      continue
    fi
    say "installing the Python packages of $group"
    if ! "$venv/bin/python" -m pip install -q --disable-pip-version-check -r "$requirements"; then
      say "pip could not install tools/requirements/$group.txt into .venv"
      exit 1
    fi
    printf '%s\n' "$checksum" > "$stamp"
  done
}

cd "$root"
add_debian_packages "$@"
install_debian_packages
if [ "$#" -gt 0 ]; then
  install_python_packages "$@"
fi
