# shellcheck shell=bash
# Sourced: installs Debian packages where this user may, and says which are needed where not.

# may_install: true where apt-get is here and this user is root or has sudo without a password.
may_install() {
    command -v apt-get >/dev/null && { [ "$(id -u)" = 0 ] || sudo -n true 2>/dev/null; }
}

# install_debian PACKAGE...: false where not allowed or not to be had; the package lists are renewed only if needed.
install_debian() {
    may_install || return 1
    local known=1 package
    for package in "$@"; do
        LC_ALL=C apt-cache policy "$package" 2>/dev/null | grep -q 'Candidate: [^(]' || known=0
    done
    echo "installing Debian packages: $*"
    if [ "$known" = 1 ] && _apt_get install -y --no-install-recommends "$@"; then return 0; fi
    _apt_get update && _apt_get install -y --no-install-recommends "$@"
}

_apt_get() {
    local root=()
    [ "$(id -u)" = 0 ] || root=(sudo -n)
    "${root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -qq -o DPkg::Lock::Timeout=120 "$@" </dev/null >/dev/null
}
