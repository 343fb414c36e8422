#!/usr/bin/env bash
# Installs the Debian package in a fresh Debian 12 without build tools, serves and computes the heave case there, and
# removes the package again. Root. usage: package.sh PACKAGE.deb [FOLDER]
set -euo pipefail
package=$(readlink -f "$1")
root=${2:-$(mktemp -d)}/debian
mirror=http://deb.debian.org/debian
fail() { echo "package: $*" >&2; exit 1; }
inside() { chroot "$root" /usr/bin/env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin DEBIAN_FRONTEND=noninteractive HOME=/root "$@"; }

[ -d "$root/usr" ] || debootstrap --variant=minbase bookworm "$root" "$mirror" >/dev/null
cleanup() { umount "$root/proc" 2>/dev/null || true; }
trap cleanup EXIT
mount -t proc proc "$root/proc"
[ ! -r /etc/resolv.conf ] || cp /etc/resolv.conf "$root/etc/"
cp "$package" "$root/tmp/quicksand.deb"
printf '#!/bin/sh\nexit 101\n' >"$root/usr/sbin/policy-rc.d" && chmod +x "$root/usr/sbin/policy-rc.d"
inside apt-get -qq -o Dpkg::Use-Pty=0 update
inside dpkg-query -W -f '${Package}\n' | sort >"$root/tmp/before"
inside apt-get -qq -o Dpkg::Use-Pty=0 install -y --no-install-recommends /tmp/quicksand.deb >/dev/null
inside sh -c '! command -v g++ && ! command -v cmake' || fail "build tools came with it"
inside quicksand --version

# As its unit does: its own user, its configuration, its state folder.
inside quicksand keys --state /tmp/keyed create root --role admin >/dev/null
as_service() { inside setpriv --reuid=quicksand --regid=quicksand --clear-groups "$@"; }
as_service quicksand serve --config /etc/quicksand/quicksand.conf --port 18080 >"$root/tmp/serve.log" 2>&1 &
for _ in $(seq 100); do grep -q ' serves ' "$root/tmp/serve.log" && break; sleep 0.1; done
url=http://127.0.0.1:18080
begin=$(date +%s)
as_service env QUICKSAND_URL=$url quicksand submit /usr/share/quicksand/cases/heave/case.json --preset draft --wait \
  >"$root/tmp/heave.log" 2>/dev/null || { cat "$root/tmp/heave.log" "$root/tmp/serve.log" >&2; fail "the heave case did not succeed"; }
grep -q 'succeeded' "$root/tmp/heave.log" || fail "no headline figures"
echo "heave in its draft size: $(($(date +%s) - begin)) s"
server=$(sed -n 's/.*"pid": *\([0-9]*\).*/\1/p' "$root/var/lib/quicksand/server.json")
kill "$server"
wait || true

inside apt-get -qq -o Dpkg::Use-Pty=0 remove -y quicksand >/dev/null
[ ! -e "$root/usr/bin/quicksand" ] || fail "the executable is still there"
[ -e "$root/etc/quicksand/quicksand.conf" ] || fail "removing took the configuration"
[ -d "$root/var/lib/quicksand/runs" ] || fail "removing took the runs"
inside apt-get -qq -o Dpkg::Use-Pty=0 purge -y quicksand >/dev/null
left=$(cd "$root" && find etc lib usr var/lib -path var/lib/dpkg -prune -o -path var/lib/apt -prune -o -name '*quicksand*' -print)
[ -z "$left" ] || fail "purging left: $left"
inside getent passwd quicksand >/dev/null && fail "purging left the user"
echo "package: installed, computed, removed and purged; $(comm -13 "$root/tmp/before" <(inside dpkg-query -W -f '${Package}\n' | sort) | wc -l) packages came with it"
