#!/usr/bin/env bash
# Builds deploy/Containerfile and computes the heave case in it, as deploy/README.md says. Root. Debian's own image is
# made with debootstrap, so that nothing but a Debian mirror is needed.
# usage: container.sh [--package PACKAGE.deb] [DEBIAN_ROOT]; with a package its first stage, which compiles it, takes that one
set -euo pipefail
top=$(dirname "$(dirname "$(dirname "$(readlink -f "$0")")")")
package=
if [ "${1:-}" = --package ]; then package=$(readlink -f "$2"); shift 2; fi
work=$(mktemp -d)
fail() { echo "container: $*" >&2; exit 1; }
trap 'buildah "${store[@]}" rm -a >/dev/null 2>&1 || true; rm -rf "$work"' EXIT
root=${1:-$work/debian}
store=(--root "$work/store" --runroot "$work/run" --storage-driver vfs)
export BUILDAH_ISOLATION=chroot
echo '{"default": [{"type": "insecureAcceptAnything"}]}' >"$work/policy.json"
policy=(--signature-policy "$work/policy.json")

[ -d "$root/usr" ] || debootstrap --variant=minbase bookworm "$root" http://deb.debian.org/debian >/dev/null
base=$(buildah "${store[@]}" from "${policy[@]}" scratch)
buildah "${store[@]}" add -q "$base" "$root" / >/dev/null
for tag in 12 12-slim; do
  buildah "${store[@]}" commit -q "${policy[@]}" "$base" docker.io/library/debian:$tag >/dev/null
done
buildah "${store[@]}" rm "$base" >/dev/null

context=$top file=$top/deploy/Containerfile
if [ -n "$package" ]; then
  context=$work/context file=$work/Containerfile
  mkdir "$context" && cp "$package" "$context/"
  sed 's|^RUN apt-get update && deploy/build-package$|RUN mkdir -p build/package \&\& mv *.deb build/package/|' "$top/deploy/Containerfile" >"$file"
  ! grep -q 'deploy/build-package$' "$file" || fail "the Containerfile compiles in another way"
fi
begin=$(date +%s)
buildah "${store[@]}" build "${policy[@]}" --pull-never -f "$file" -t quicksand "$context" >"$work/build.log" 2>&1 \
  || { tail -n 40 "$work/build.log" >&2; fail "it does not build"; }
echo "container: built in $(($(date +%s) - begin)) s"

container=$(buildah "${store[@]}" from "${policy[@]}" --pull-never quicksand)
user=$(buildah "${store[@]}" run "$container" -- id -u)
[ "$user" != 0 ] || fail "it runs as root"
buildah "${store[@]}" run "$container" -- sh -c '! command -v g++ && ! command -v cmake' || fail "build tools came with it"
mkdir "$work/state" && chown "$user:$user" "$work/state"
inside() { buildah "${store[@]}" run -v "$work/state:/var/lib/quicksand" "$container" -- "$@"; }
inside quicksand --version
key=$(inside quicksand keys --state /var/lib/quicksand create me --role admin | tail -n 1)
# What the image starts by itself, on a port that is free here.
mapfile -t start < <(buildah "${store[@]}" inspect --format '{{range .OCIv1.Config.Entrypoint}}{{println .}}{{end}}{{range .OCIv1.Config.Cmd}}{{println .}}{{end}}' "$container" | grep .)
inside "${start[@]}" --port 18081 >"$work/serve.log" 2>&1 &
serving=$!
for _ in $(seq 100); do grep -q ' serves ' "$work/serve.log" && break; sleep 0.1; done
begin=$(date +%s)
inside env QUICKSAND_URL=http://127.0.0.1:18081 QUICKSAND_KEY="$key" \
  quicksand submit /usr/share/quicksand/cases/heave/case.json --preset draft --wait >"$work/heave.log" 2>&1 \
  || { cat "$work/heave.log" "$work/serve.log" >&2; fail "the heave case did not succeed"; }
echo "container: heave in its draft size: $(($(date +%s) - begin)) s"
kill "$(sed -n 's/.*"pid": *\([0-9]*\).*/\1/p' "$work/state/server.json")"
begin=$(date +%s)
wait $serving || fail "it did not stop in order"
[ $(($(date +%s) - begin)) -lt 10 ] || fail "it took too long to stop"
[ -n "$(ls "$work/state/runs")" ] || fail "the volume does not hold the runs"
echo "container: built, computed as user $user with the runs in its volume, stopped"
