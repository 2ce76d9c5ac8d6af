# cli_support.sh - sourced by the command-line tests: run a command, check its status and what it said.
# Variables: work (scratch folder), out and err (files with the last command's output).
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
out=$work/.out
err=$work/.err

# The folder of generated models, made once for each test.
models() {
    need parian-models
    [ -d "$work/models" ] || parian-models -o "$work/models" "$@" > /dev/null || fail "parian-models failed"
}
need() { command -v "$1" > /dev/null || { echo "skipped: $1 is not built"; exit 77; }; }
fail() {
    echo "FAILED: $*"
    [ -f "$err" ] && sed 's/^/  stderr: /' "$err" | head -20
    exit 1
}
# expect STATUS command...: run it, keep its output, insist on its exit status.
expect() {
    local want=$1 got
    shift
    "$@" > "$out" 2> "$err" < /dev/null
    got=$?
    [ "$got" = "$want" ] || fail "'$*' ended with $got, expected $want"
}
contains() { grep -qF -- "$2" "$1" || fail "'$2' is missing in $(cat "$1" | head -c 2000)"; }
lacks() { ! grep -qF -- "$2" "$1" || fail "'$2' should not be in $(cat "$1" | head -c 2000)"; }
# The file holds exactly one line, warnings aside.
one_line() {
    local n
    n=$(grep -cv 'warning:' "$1")
    [ "$n" = 1 ] || fail "expected one line, got $n: $(cat "$1")"
}
# A closed tetrahedron in OFF form.
write_tetrahedron() {
    printf 'OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n' > "$1"
}
done_ok() { echo "ok"; exit 0; }
