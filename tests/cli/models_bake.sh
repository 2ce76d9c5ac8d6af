# models_bake.sh - each example model bakes without a warning, from its own media, and its asset is valid.
set -u
. "$PARIAN_SOURCE_DIR/tests/support/cli_support.sh"
need parian-bake
need parian-info
need parian-models
[ "${PARIAN_SANITIZED:-0}" = 0 ] || { echo "skipped: too slow with sanitizers"; exit 77; }
expect 0 parian-models -q --triangles 40000 -o "$work" figurine candle cup leaf sphere slab
for name in figurine candle cup leaf sphere slab; do
    expect 0 parian-bake "$work/$name.glb" --transfer-vertices 2000 --atlas 256 -o "$work/$name.parian"
    lacks "$err" "warning"
    expect 0 parian-info validate "$work/$name.parian"
    rm "$work/$name.parian"
done
# The files that are meant to be refused, and those that are meant to bake.
expect 0 parian-models -q --nasty "$work/nasty"
while read -r name status; do
    [ "$status" = any ] && continue
    expect "$status" parian-bake "$work/nasty/$name" -q --scale 50mm --material marble --transfer-vertices 800 \
        --atlas 256 -o "$work/n.parian"
done < "$work/nasty/expected.txt"
done_ok
