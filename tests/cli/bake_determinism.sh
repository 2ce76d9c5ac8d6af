# bake_determinism.sh - the same bytes for 1, 2 and 7 threads, for every local form and both forms.
set -u
. "$PARIAN_SOURCE_DIR/tests/support/cli_support.sh"
need parian-bake
models --triangles 6000 figurine

bake() { # NAME THREADS options...
    local name=$1 threads=$2
    shift 2
    expect 0 parian-bake "$work/models/figurine.glb" -q --threads "$threads" --transfer-vertices 800 --atlas 128 \
        -o "$work/$name.$threads.parian" "$@"
}
for form in "--local rebuilt" "--local f16" "--local u8" "--local split" "--form paper" "--bssrdf dipole-flux"; do
    name=$(echo "$form" | tr -c 'a-z0-9' _)
    # shellcheck disable=SC2086
    for threads in 1 2 7; do bake "$name" $threads --force-local --force-global $form; done
    cmp "$work/$name.1.parian" "$work/$name.2.parian" || fail "$form: 1 and 2 threads differ"
    cmp "$work/$name.1.parian" "$work/$name.7.parian" || fail "$form: 1 and 7 threads differ"
    expect 0 parian-info validate "$work/$name.1.parian"
done
done_ok
