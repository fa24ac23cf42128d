# shellcheck shell=bash
# Sourced by run.sh and test.sh.

# Installs the packages of packages.txt whose group is one of the arguments and that are missing. Needs no input.
installPackages() {
  local group package rest missing=()
  while read -r group package rest; do
    [[ " $* " == *" $group "* ]] || continue
    [[ $(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null) == installed ]] || missing+=("$package")
  done <packages.txt
  ((${#missing[@]})) || return 0

  if ! command -v apt-get >/dev/null; then
    echo "This is no Debian system. Install what stands for these packages by hand: ${missing[*]}" >&2
    return 1
  fi
  local asRoot=()
  if ((EUID != 0)); then
    if ! command -v sudo >/dev/null; then
      echo "These packages are missing: ${missing[*]}" >&2
      echo "Installing them needs root or sudo. As root: apt-get install ${missing[*]}" >&2
      return 1
    fi
    asRoot=(sudo)
  fi
  echo "Installing ${missing[*]}"
  "${asRoot[@]}" apt-get update -qq
  "${asRoot[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "${missing[@]}" </dev/null >/dev/null
}
