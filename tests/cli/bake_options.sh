# bake_options.sh - parian-bake's command line: statuses, messages, configuration, presets.
set -u
. "$PARIAN_SOURCE_DIR/tests/support/cli_support.sh"
need parian-bake

ply=$work/tetrahedron.off
write_tetrahedron "$ply"

expect 0 parian-bake --help
contains "$out" "--transfer-vertices"
contains "$out" "parian-bake figurine.glb"
lacks "$out" "--samples"
expect 0 parian-bake --version
expect 1 parian-bake
expect 1 parian-bake "$ply"                         # no output
expect 1 parian-bake "$ply" -o "$work/a.parian"     # no unit
contains "$err" "--scale"
one_line "$err"
expect 1 parian-bake "$ply" -o "$work/a.parian" --scale 50
expect 1 parian-bake "$ply" -o "$work/a.parian" --scale -5mm
expect 1 parian-bake "$ply" -o "$work/a.parian" --scale 50mm --unit mm
expect 1 parian-bake "$ply" -o "$work/a.parian" --scale 50mm --kernel 8
expect 1 parian-bake "$ply" -o "$work/a.parian" --scale 50mm --kernel 17
expect 1 parian-bake "$ply" -o "$work/a.parian" --scale 50mm --atlas 1000000
expect 1 parian-bake "$ply" -o "$work/a.parian" --scale 50mm --threshold nan
expect 1 parian-bake "$ply" -o "$work/a.parian" --scale 50mm --no-local --no-global
expect 1 parian-bake "$ply" -o "$work/a.parian" --scale 50mm --material granite9
contains "$err" "--list-materials"
expect 1 parian-bake "$ply" -o "$work/a.parian" --scale 50mm --material nobody=marble
expect 1 parian-bake "$ply" -o "$work/a.parian" --frobnicate
expect 5 parian-bake "$ply" -o "$work/a.parian" --scale 50mm --samples 100
expect 5 parian-bake "$ply" -o "$work/a.parian" --scale 50mm --max-error 0.01
expect 5 parian-bake reference "$ply"
expect 2 parian-bake "$work/absent.ply" --scale 50mm -o "$work/a.parian"
contains "$err" "absent.ply"
one_line "$err"
expect 2 parian-bake "$ply" --scale 50mm -o "$work/no/such/folder/a.parian"
expect 5 parian-bake "$work/model.fbx" --scale 50mm -o "$work/a.parian"
[ ! -e "$work/a.parian" ] || fail "a failed run left an asset"

expect 0 parian-bake --list-materials
contains "$out" "Marble"
contains "$out" "Skimmilk"
expect 0 parian-bake --print-config --quality preview --kernel 5
contains "$out" '"kernel":	5'
contains "$out" '"atlas":	256'

cat > "$work/medium.json" <<'JSON'
{"name": "soap", "sigma_s_prime": [2, 2.5, 3], "sigma_a": 0.01, "eta": 1.4, "unit": "1/mm", "source": "test"}
JSON
expect 0 parian-bake "$ply" --scale 20mm --material "$work/medium.json" --transfer-vertices 300 --atlas 64 \
    -o "$work/soap.parian" --report "$work/soap.json" -MD --dump "$work/dump"
contains "$work/soap.json" '"soap"'
contains "$work/soap.parian.d" "medium.json"
[ -s "$work/dump/texel_position.npy" ] || fail "no texel_position.npy"
[ -s "$work/dump/body0_atlas.png" ] || fail "no atlas picture"
expect 0 parian-info validate "$work/soap.parian"

echo '{"sigma_s_prime": [2, -1, 3], "sigma_a": 0.01}' > "$work/bad.json"
expect 3 parian-bake "$ply" --scale 20mm --material "$work/bad.json" -o "$work/a.parian"
one_line "$err"
done_ok
